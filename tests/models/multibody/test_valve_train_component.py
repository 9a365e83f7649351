"""The valve train as one component: the mechanism's equations, energies, and the minimal model's motion."""

import math
import re
from typing import Any

import numpy as np
import pytest

from models.catalogue import CATALOGUE
from models.core.component import Component
from models.core.quantities import Vector
from models.core.system import Instance, System
from models.monolithic import solve
from models.monolithic.equilibrium import equilibrium
from models.multibody.beams import fill_beam_stiffness, fill_modal_damping
from models.multibody.direct_train import CONTACT, DRIVE, GUIDE, TrainStart, direct_train
from models.multibody.forces import modal_damping
from models.multibody.mechanism import Mechanism
from models.valve_train.multibody_valve_train import multibody_valve_train

from ..systems import valve_train

FILM = 0.7e-6
SPEED = 150.0
SURFACES = ("entraining_velocity", "sliding_velocity", "radius_of_curvature")
# A train whose numbers are all its own.
OTHER = {
    "shaft_length": 0.08, "shaft_diameter": 0.017, "mass": 0.31, "polar_inertia": 2e-4, "base_radius": 0.023,
    "valve_mass": 0.19, "spring_rate": 31e3, "preload": 280.0, "damping_ratio": 0.05, "drive_ratio": 0.5,
    "contact_damping": 0.0,
}  # fmt: skip


@pytest.fixture(scope="module")
def component():
    return multibody_valve_train()


def begin(component: Component, flexible: float, angle: float) -> tuple[Mechanism, Vector, Vector, Vector]:
    """A bent, twisted and moving train as a mechanism; parameters, states and inputs of the component."""
    p = component.parameters.vector({**OTHER, "flexible": flexible})
    record = component.parameters.view(p)
    start = TrainStart(
        angle=angle, position=3e-3, coil_positions=(2e-3, 1e-3), film=FILM, twist=2e-4, bending=-2e-5,
        slope=3e-4,
    )  # fmt: skip
    valve, oil = _fill("valve_spring", record), _fill("ehl_contact", record)
    train = direct_train(record, valve, SPEED, lubricant=oil, start=start)
    u = {"drive_angle": angle / 0.5, "drive_speed": SPEED / 0.5, "film_thickness": FILM}
    return train, p, _read_states(component, train, angle), component.inputs.vector(u)


def _fill(name: str, record: Any) -> Any:
    """The parameters of a component, as far as the train has them."""
    filled = CATALOGUE[name]().parameters.defaults()
    for field in set(filled.dtype.names) & set(record.dtype.names):
        filled[field] = record[field]
    return filled


def _read_states(component: Component, train: Mechanism, angle: float) -> Vector:
    """The assembled mechanism's coordinates and velocities, counted as the component counts them."""
    begun, x = train.start(), component.state.vector()
    state, places = component.state.view(x), np.array([body.position for body in train.bodies])
    places[1] = 0.0, 0.0, places[1, 2]
    lifted = np.array([0.0, 0.0, 3e-3, 2e-3, 1e-3])
    places[:, 1] -= lifted
    q, v = begun.q.reshape(-1, 2, 3), begun.v.reshape(-1, 2, 3)
    turned = np.array([[0.0, 0.0, angle]] * 2 + [[0.0] * 3] * 3)
    turning = np.array([[0.0, 0.0, SPEED]] * 2 + [[0.0] * 3] * 3)
    state.position, state.angle = (q[:, 0] - places).ravel(), (q[:, 1] - turned).ravel()
    state.velocity, state.angular_velocity = v[:, 0].ravel(), (v[:, 1] - turning).ravel()
    return x


@pytest.mark.plain
@pytest.mark.parametrize("flexible", [0.0, 1.0])
def test_accelerations_and_loads_are_those_of_the_mechanism(component, flexible):
    """Cholesky's factors of J M^-1 J^T in kernels against the whole matrix, for a train of other numbers."""
    train, p, x, u = begin(component, flexible, 2.1)
    dx, y = np.zeros_like(x), np.zeros(component.outputs.size)
    begun = train.start()
    assert component.start_faults(p, x, u) == []
    component.flat_derivative(0.0, x, u, p, dx)
    component.flat_output(0.0, x, u, p, y)
    found, outputs = component.state.view(dx), component.outputs.named(y)
    expected = begun.a.reshape(-1, 2, 3)
    scale = np.max(np.abs(begun.a))
    np.testing.assert_allclose(found.velocity, expected[:, 0].ravel(), atol=1e-9 * scale)
    np.testing.assert_allclose(found.angular_velocity, expected[:, 1].ravel(), atol=1e-9 * scale)
    e = train.evaluate(0.0, begun.q, begun.v)
    torque = begun.multipliers[train.find_rows(DRIVE)][0]
    guide = begun.multipliers[train.find_rows(GUIDE)] @ e.held.jacobian[train.find_rows(GUIDE), 17]
    assert outputs["load"] == pytest.approx(e.load[train.contacts.index(CONTACT)], rel=1e-9)
    assert outputs["drive_torque"] == pytest.approx(0.5 * torque, rel=1e-8)
    assert outputs["guide_moment"] == pytest.approx(guide, rel=1e-8)
    assert outputs["constraint_violation"] < 1e-12


@pytest.mark.plain
def test_stored_energy_changes_by_the_powers(component):
    """dE/dt = source - loss + drive torque times speed, where the cam's radius is constant."""
    p = component.parameters.vector({"flexible": 1.0})
    random = np.random.default_rng(1)
    x = 1e-3 * component.state.nominal * random.standard_normal(component.state.size)
    rates = {"drive_angle": 90.0, "drive_speed": 500.0, "film_thickness": 2e-3}
    u = component.inputs.vector(
        {"drive_angle": 0.2, "drive_speed": 90.0, "drive_acceleration": 500.0, "film_thickness": 2e-6,
         "film_rate": 2e-3}
    )  # fmt: skip
    du, dx, e = np.zeros_like(u), np.zeros_like(x), np.zeros(3)
    for name, rate in rates.items():
        du[component.inputs.index(name)] = rate
    component.flat_derivative(0.0, x, u, p, dx)
    y = np.zeros(component.outputs.size)
    component.flat_output(0.0, x, u, p, y)
    torque = y[component.outputs.index("drive_torque")]

    def store(h):
        component.flat_energy(0.0, x + h * dx, u + h * du, p, e)
        return float(e[0])

    h = 1e-7
    slope = (8.0 * (store(h) - store(-h)) - store(2.0 * h) + store(-2.0 * h)) / (12.0 * h)
    component.flat_energy(0.0, x, u, p, e)
    assert e[1] > 0.01
    assert slope == pytest.approx(e[2] - e[1] + torque * 90.0, rel=1e-6, abs=1e-6)


def test_damping_of_a_beam_by_blocks_is_that_by_modes():
    k, c = np.zeros((6, 6)), np.zeros((6, 6))
    fill_beam_stiffness(0.1, 0.02, 207e9, 0.3, 10.0 / 9.0, k)
    masses = np.array([0.4, 0.4, 0.4, 3e-4, 1.4e-4, 1.4e-4])
    fill_modal_damping(k, masses, 0.02, c)
    np.testing.assert_allclose(c, modal_damping(k, masses, 0.02), rtol=1e-12, atol=1e-12 * c.max())


def test_a_number_of_spring_masses_out_of_range_is_refused():
    with pytest.raises(ValueError, match="coil_masses = 11: must be from 1 to 10"):
        multibody_valve_train(coil_masses=11)


def couple(speed_rpm: float) -> System:
    """The train with a film formula, as the scenario couples them."""
    speed = speed_rpm * math.pi / 30.0
    pairs = [
        *((f"flywheel.{name}", f"train.drive_{name}") for name in ("angle", "speed", "acceleration")),
        ("train.drive_torque", "flywheel.load_torque[1]"),
        ("train.elastic_load", "contact.applied_load"),
        *((f"train.{name}", f"contact.{name}") for name in SURFACES),
        ("contact.film_thickness", "train.film_thickness"),
        ("contact.squeeze_velocity", "train.film_rate"),
    ]
    turning = {"initial_speed": speed, "final_speed": speed, "motion": 1.0}
    return System(
        {
            "flywheel": Instance(CATALOGUE["flywheel"](), turning, start={"speed": speed}),
            "train": Instance(multibody_valve_train()),
            "contact": Instance(CATALOGUE["ehl_contact"](), {"load_is_given": 1.0}),
        },
        pairs,
    )


@pytest.mark.parametrize("share", [1e-5, 0.99, 1.01])
def test_a_valve_too_light_for_its_contact_is_refused(component, share):
    """c/m <= 1e7 1/s with c = 920 N s/m (330 N/450 N)."""
    least = 920.0 * 330.0 / 450.0 / 1e7
    faults = component.parameter_faults(component.parameters.vector({"valve_mass": share * least}))
    assert [fault.partition(" kg: ")[0] for fault in faults] == (
        [] if share > 1.0 else [f"valve_mass = {share * least:g}"]
    )
    assert all("must be >= 6.75e-05 kg" in fault for fault in faults)


@pytest.mark.plain
@pytest.mark.parametrize("flexible", [0.0, 1.0])
def test_a_start_that_its_joints_do_not_allow_is_named_with_the_joint(component, flexible):
    """Sliding along its guide, bending and turning of the cam on an elastic shaft are free."""
    p = component.parameters.vector({"flexible": flexible})
    u = component.inputs.vector({"drive_angle": 0.7, "drive_speed": 100.0, "film_thickness": FILM})
    held = {
        "position[7]": "position: .* violates guide: along first axis by 1e-05",
        "angle[7]": "position: .* violates guide: about first axis by 1e-05",
        "angle[3]": "position: .* violates drive: turning by 1e-05",
        "position[1]": "position: .* violates bearing: along",
        "velocity[12]": "velocity: .* violates guide of spring mass 5: along",
        "angular_velocity[3]": "velocity: .* violates drive: turning by 1e-05: must be <= 1e-06 in SI units",
    }
    free = {"position[8]": "", "velocity[8]": ""}
    on_the_cam = {"position[5]": "position: .* violates shaft and cam: along y", "angle[6]": "shaft and cam"}
    for name, message in {**held, **free, **on_the_cam}.items():
        x = component.state.vector()
        x[component.state.index(name)] = 1e-5
        faults = component.start_faults(p, x, u)
        if name in free or (flexible and name in on_the_cam):
            assert faults == []
        else:
            assert re.search(message, faults[0])


@pytest.mark.long
def test_multipliers_and_minimal_model_move_alike_on_the_film():
    """K's coupling, load one way and film the other, against the components, both solved whole."""
    times = np.linspace(0.0, 0.06, 3001)
    one, other = (
        solve(system, times, x0=equilibrium(system, 0.0)) for system in (couple(1000.0), valve_train(1000.0))
    )
    for name, minimal, limit in (
        ("train.load", "contact.load", 1e-6),
        ("contact.film_thickness", "contact.film_thickness", 1e-7),
        ("train.drive_torque", "camshaft.drive_torque", 1e-6),
        ("train.position", "valve_spring.position", 1e-9),
    ):
        error = np.sqrt(np.mean((one[name] - other[minimal]) ** 2)) / np.std(other[minimal])
        assert error < limit
