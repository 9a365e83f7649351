"""K's valve train as K writes it, with 21 constraints, against minimal models."""

import math

import numpy as np
import pytest

from models.contact.ehl_contact import ContactParameters
from models.core.quantities import Layout
from models.monolithic import solve
from models.monolithic.equilibrium import equilibrium
from models.multibody.direct_train import CONTACT, DRIVE, GUIDE, TrainStart, direct_train
from models.multibody.ida import solve_ida
from models.multibody.mechanism import Mechanism
from models.valve_train.camshaft import CamshaftParameters
from models.valve_train.valve_spring import ValveSpringParameters
from reproduction.adherence import solve_adherence

from ..systems import valve_train
from .projected import solve_projected

# States of the camshaft in which it starts.
BENT = ("twist", "bending", "slope", "bending_across", "slope_across")


def train(speed_rpm: float, flexible: bool = True, **parameters: float) -> Mechanism:
    camshaft, valve = Layout(CamshaftParameters).defaults(), Layout(ValveSpringParameters).defaults()
    camshaft.flexible = float(flexible)
    for name, value in parameters.items():
        setattr(camshaft if name in camshaft.dtype.names else valve, name, value)
    return direct_train(camshaft, valve, speed_rpm * math.pi / 30.0)


def test_parts_joints_and_freedoms_are_those_of_ks_tables_1_and_2():
    mechanism = train(1000.0)
    assert [len(joint.constraints) for joint in mechanism.joints] == [4, 1, 1, 5, 5, 5]
    # The shaft slides in its bearing, the cam has six but the contact, follower and coils share three.
    assert (len(mechanism.bodies), mechanism.freedoms) == (5, 9)


@pytest.mark.long
@pytest.mark.parametrize("speed_rpm", [600.0, 1000.0, 3000.0])
def test_multibody_and_minimal_model_agree_on_a_rigid_shaft(speed_rpm, record):
    """Load, drive torque, guide moment and lift against the adherence form of the components.

    Their starts differ by the deflection of the contact, which shakes the coils: 1e-8 of the load is left
    after 0.15 s.
    """
    settled = math.ceil(0.15 * speed_rpm / 60.0)
    times = np.append(0.0, np.linspace(settled, settled + 1, 721) * 60.0 / speed_rpm)
    minimal = solve_adherence(valve_train(speed_rpm), times, 1e-9)
    motion = solve_ida(train(speed_rpm, flexible=False), times)
    load, torque = motion.multiplier(CONTACT)[:, 0], motion.multiplier(DRIVE)[:, 0]
    guide = motion.reaction(GUIDE).moment[:, 2]
    place = motion.position("follower")[:, 1]
    pairs = {
        "load": (load, minimal["contact.load"]),
        "drive torque": (torque, minimal["camshaft.drive_torque"]),
        "guide moment": (guide, -minimal["contact.load"] * minimal["camshaft.contact_offset"]),
        "lift": (place - place[0], minimal["valve_spring.position"]),
    }
    for name, (found, expected) in pairs.items():
        error = np.max(np.abs(found - expected)[1:]) / np.max(np.abs(expected))
        quantity = f"{name} on a rigid shaft, error over largest value"
        record("Multibody", quantity, error, 0.0, "minimal model, adherence", tolerance=1e-6)


@pytest.mark.long
@pytest.mark.parametrize("speed_rpm", [600.0, 1000.0, 3000.0])
def test_multibody_and_minimal_model_agree_on_a_flexible_shaft(speed_rpm, record):
    """A revolution from the same start: what the turning of shaft and cam does is in both.

    Without gyroscopic moment, turning damping and the cam's own axis the load misses 1e-3 at 3000 r/min.
    """
    times = np.linspace(0.0, 60.0 / speed_rpm, 721)
    minimal = solve_adherence(valve_train(speed_rpm, camshaft={"flexible": 1.0}), times, 1e-10)
    states = dict(zip(minimal.system.state.names, minimal.state.T, strict=True))
    begin = {name: float(values[0]) for name, values in states.items()}
    camshaft, valve = Layout(CamshaftParameters).defaults(), Layout(ValveSpringParameters).defaults()
    camshaft.flexible = 1.0
    start = TrainStart(
        position=begin["valve_spring.position"],
        coil_positions=(begin["valve_spring.coil_position[1]"], begin["valve_spring.coil_position[2]"]),
        **{name: begin[f"camshaft.{name}"] for name in BENT},
    )
    motion = solve_ida(direct_train(camshaft, valve, speed_rpm * math.pi / 30.0, start=start), times, 1e-10)
    load, axis = minimal["contact.load"], motion.position("cam")
    pairs = {
        "load": (motion.multiplier(CONTACT)[:, 0], load),
        "drive torque": (motion.multiplier(DRIVE)[:, 0], minimal["camshaft.drive_torque"]),
        "guide moment": (motion.reaction(GUIDE).moment[:, 2], -load * minimal["camshaft.contact_offset"]),
        "lift": (motion.position("follower")[:, 1] - camshaft.base_radius, minimal["valve_spring.position"]),
        "axis along": (axis[:, 1], states["camshaft.bending"]),
        "axis across": (axis[:, 0], states["camshaft.bending_across"]),
    }
    for name, (found, expected) in pairs.items():
        error = np.sqrt(np.mean((found - expected) ** 2)) / np.std(expected)
        quantity = f"{name} on a flexible shaft at {speed_rpm:g} r/min, relative RMS"
        record("Multibody", quantity, error, 0.0, "minimal model, adherence", tolerance=1e-5)


@pytest.mark.long
def test_both_methods_agree_at_3000_r_min(record):
    """Backward differences of the stabilised form and projected Runge-Kutta of index 1."""
    times, mechanism = np.linspace(0.0, 0.02, 361), train(3000.0)
    one, other = solve_ida(mechanism, times), solve_projected(mechanism, times)
    scale = np.max(np.abs(other.multiplier(CONTACT)))
    error = np.max(np.abs(one.multiplier(CONTACT) - other.multiplier(CONTACT))) / scale
    case = "contact load by IDA and by projected DOP853"
    record("Multibody", case, error, 0.0, "two methods", tolerance=2e-6)
    for method, motion, tolerance in (("IDA", one, 5e-6), ("projected DOP853", other, 1e-12)):
        quantity = f"largest violation of a constraint or its rate, {method} (m, rad, 1/s)"
        record("Multibody", quantity, max(motion.drift), 0.0, "constraints", tolerance=tolerance)


@pytest.mark.long
def test_the_film_carries_the_train_as_in_the_components(record):
    """Load and film thickness over a revolution, both from the same start, on a rigid shaft."""
    system = valve_train(1000.0)
    begin = equilibrium(system, 0.0)
    states = dict(zip(system.state.names, begin, strict=True))
    start = TrainStart(
        position=states["valve_spring.position"],
        coil_positions=(states["valve_spring.coil_position[1]"], states["valve_spring.coil_position[2]"]),
        film=states["contact.film_thickness"],
    )
    times = np.linspace(0.0, 0.06, 3001)
    minimal = solve(system, times, 1e-9, x0=begin)
    camshaft, valve, oil = (
        Layout(kind).defaults() for kind in (CamshaftParameters, ValveSpringParameters, ContactParameters)
    )
    train = direct_train(camshaft, valve, 1000.0 * math.pi / 30.0, lubricant=oil, start=start)
    motion = solve_ida(train, times)
    load = motion.load(CONTACT)
    error = np.sqrt(np.mean((load - minimal["contact.load"]) ** 2)) / np.std(load)
    record("Multibody", "load on the film, relative RMS", error, 0.0, "monolithic reference", tolerance=5e-5)
    film = motion.film_thickness(CONTACT)
    error = np.max(np.abs(film - minimal["contact.film_thickness"])) / np.max(film)
    quantity = "film thickness, error over largest"
    record("Multibody", quantity, error, 0.0, "monolithic reference", tolerance=1e-5)
