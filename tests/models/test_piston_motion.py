"""The tilting piston in motion: roller limit, energy, symmetry, walls, cutting of time, bad input.

Mechanism of Flores, Leine and Glocker (2010), against a time-stepping method written here.

Moreau's midpoint rule with their equations of motion (theta_1, theta_2, theta_3 of the bodies), contact
law and data: nothing of `models` but the data. Its error falls with the first power of the step, as it
finds impacts to a step only.
"""

import itertools
import math
from dataclasses import dataclass

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from models.catalogue import CATALOGUE
from models.core.system import Instance, System
from models.monolithic import solve
from tests.models.slider_cranks import FLORES

from .slider_cranks import (
    CRANK,
    DRIVEN,
    FREE,
    ROLLER,
    STATE,
    advance,
    power_imbalance,
    thesis_parameters,
    turn,
)
from .systems import outputs_of, wheel

CORNERS = ("upper_front", "upper_rear", "lower_front", "lower_rear")
ENGINE_SPEED = 2000.0 * math.pi / 30.0
# Asymmetric in every respect.
UNEVEN = {"pin_offset": 1e-3, "mass_offset": -0.5e-3}


def test_roller_is_the_nonlinear_slider_crank():
    """The same impacts and events as the other component in its nonlinear form."""
    damping, gap, start, horizon = 0.05, 0.015, 0.2, 10.0
    values = {**ROLLER, "crank_pin_friction": damping, "clearance": gap, "restitution": 0.9}
    ours = turn(
        DRIVEN, DRIVEN.state.vector({"offset": 0.005}), DRIVEN.parameters.vector(values), start, horizon
    )
    phi = math.asin(0.303 * math.sin(start))
    psi = phi - math.asin(math.sin(phi) - 0.005)
    # psi' of a piston at rest across the bore.
    slope = 0.303 * math.cos(start)
    psi_rate = slope / math.cos(phi) - slope / math.cos(phi - psi)
    x = STATE.vector({"psi": psi, "psi_rate": psi_rate})
    named = turn(CRANK, x, thesis_parameters(damping, gap, form=2.0), start, horizon)
    assert ours["impact_count"] == named["impact_count"] > 5.0
    # Errors of 1e-10 grow by e^(0.41 per rad) at most.
    assert ours["event_count"] == named["event_count"]
    for time in ("last_impact_time", "last_event_time"):
        assert ours[time] == pytest.approx(named[time], abs=1e-7)
    assert ours["piston_offset"] == pytest.approx(named["piston_offset"], abs=1e-8)
    assert ours["upper_wall_impulse"] == pytest.approx(named["upper_wall_impulse"], abs=1e-7)
    assert ours["crank_impact_impulse"] == pytest.approx(named["crank_impact_impulse"], abs=1e-7)


@pytest.mark.long
def test_energy_balances_through_impacts_chatter_and_sliding():
    """An engine's expansion stroke, with every kind of contact."""
    system = System(
        {
            "flywheel": wheel(ENGINE_SPEED),
            "gas": Instance(CATALOGUE["cylinder_gas"]()),
            "piston": Instance(DRIVEN, {"mass_offset": -0.5e-3}),
        },
        [
            ("flywheel.angle", "gas.crank_angle"),
            ("flywheel.speed", "gas.crank_speed"),
            ("flywheel.angle", "piston.crank_angle"),
            ("flywheel.speed", "piston.crank_speed"),
            ("flywheel.acceleration", "piston.crank_acceleration"),
            ("gas.gas_pressure", "piston.gas_pressure"),
            ("piston.crank_torque", "flywheel.load_torque[1]"),
        ],
    )
    found = solve(system, np.linspace(0.0, 4e-3, 81), tolerance=1e-8)
    assert found["piston.impact_count"][-1] > 10.0
    assert found["piston.upper_wall_impulse"][-1] + found["piston.lower_wall_impulse"][-1] > 1.0
    # Of some 300 J that pass through.
    assert np.abs(found.energy["piston"].residual).max() < 3e-8
    # The gas moves a piston without clearance: in error by offset / rod length over crank angle.
    assert found["gas.indicated_work"][-1] == pytest.approx(found.energy["piston"].sourced[-1], rel=2e-3)


MODES = ((), (0,), (3,), (0, 1), (2, 3), (0, 3), (1, 2))


@pytest.mark.parametrize("closed", MODES)
def test_power_balances_at_every_instant(closed):
    """d(stored)/dt = torque * speed - friction + gas in every mode of contact."""
    rng = np.random.default_rng(len(closed))
    p = DRIVEN.parameters.vector(
        {**UNEVEN, "crank_mass": 1.0, "crank_centre": 0.02, "gravity_along": -9.0, "gravity_across": 3.0}
    )
    x = DRIVEN.state.vector({f"closed[{i + 1}]": 1.0 for i in closed})
    for _ in range(10):
        x[:4] = rng.uniform(-1.0, 1.0, 4) * np.array([1e-5, 0.3, 2e-4, 5.0])
        theta, speed, acceleration, pressure = rng.uniform(-1.0, 1.0, 4) * [3.0, 300.0, 1e4, 4e6]
        U = DRIVEN.input_polynomial()
        U[0], U[1, :2], U[2, 0] = (theta, speed, acceleration, pressure), (speed, acceleration), acceleration
        imbalance, size = power_imbalance(DRIVEN, x, U, p)
        assert abs(imbalance) < 1e-6 * (size + 1e3)


def test_reflection_of_the_mechanism_reflects_the_motion():
    """y -> -y with theta -> -theta: upper and lower corners change places."""
    values = {**UNEVEN, "gravity_across": -9.81}
    mirrored = {name: -value for name, value in values.items()}
    start = {"offset": 1e-5, "tilt": 3e-4, "offset_rate": 0.1}
    x = DRIVEN.state.vector(start)
    z = DRIVEN.state.vector({name: -value for name, value in start.items()})
    one = turn(DRIVEN, x, DRIVEN.parameters.vector(values), 0.4, 6.0, 150.0)
    other = advance(
        DRIVEN, z, DRIVEN.parameters.vector(mirrored), 0.4 / 150.0, 6.0 / 150.0,
        crank_angle=(-0.4, -150.0), crank_speed=-150.0,
    )  # fmt: skip
    assert one["impact_count"] == other["impact_count"] > 10.0
    signs = {"piston_offset": -1, "piston_tilt": -1, "piston_position": 1, "crank_torque": -1}
    for name, sign in signs.items():
        assert one[name] == pytest.approx(sign * other[name], rel=1e-9)
    for i, j in ((1, 3), (2, 4)):
        assert one[f"corner_impact_count[{i}]"] == other[f"corner_impact_count[{j}]"]
        assert one[f"corner_impact_impulse[{i}]"] == pytest.approx(other[f"corner_impact_impulse[{j}]"])


@settings(max_examples=30, deadline=None, derandomize=True)
@example(0.0, 0.0, 0.0, 0.6102018349507986, 0.06807003997509296, -0.0010901036, 1995304.0, 1.0)
@given(
    offset=st.floats(-1.0, 1.0),
    tilt=st.floats(-1.0, 1.0),
    rate=st.floats(-0.5, 0.5),
    restitution=st.floats(0.0, 0.9),
    friction=st.floats(0.0, 0.2),
    pin_offset=st.floats(-2e-3, 2e-3),
    pressure=st.floats(0.0, 3e6),
    start=st.floats(0.0, 6.0),
)
def test_walls_are_never_passed_and_only_push(
    offset, tilt, rate, restitution, friction, pin_offset,
    pressure, start):  # fmt: skip
    values = {"restitution": restitution, "wall_friction": friction, "pin_offset": pin_offset}
    p = DRIVEN.parameters.vector(values)
    clearance = 40e-6
    leaning = tilt * clearance / 0.025
    x = DRIVEN.state.vector(
        {"offset": offset * clearance * (1.0 - abs(tilt)), "tilt": 0.99 * leaning, "offset_rate": rate}
    )
    assert DRIVEN.start_faults(p, x, DRIVEN.inputs.vector()) == []
    losses = 0.0
    for part in range(20):
        angle = start + 0.3 * part
        crank = {"crank_angle": (angle, 200.0), "crank_speed": 200.0, "gas_pressure": pressure}
        y = advance(DRIVEN, x, p, angle / 200.0, 0.3 / 200.0, **crank)
        # Gaps are known to rounding; at a release the force is zero to rounding.
        assert min(y[f"{corner}_gap"] for corner in CORNERS) >= -1e-14 * clearance
        assert min(y[f"{corner}_force"] for corner in CORNERS) >= -1e-9
        if restitution == 0.0 or friction == 0.0:  # unequal e_N and e_T may give energy
            assert y["impact_loss"] >= losses - 1e-12
        losses = y["impact_loss"]


def test_bounces_of_two_corners_end():
    """A piston that rattles between two opposite corners comes to rest at both walls, in the reference too.

    One of them is pressed only while the other rests, and its impacts throw that one up. The rattle is ended
    before the instant to which it converges by about the chatter time: the estimate leaves these flights out.
    """
    start = {"tilt": 1.553e-3, "tilt_rate": -0.1656, "closed[1]": 1.0}
    values = {"restitution": 0.61, "wall_friction": 0.068, "pin_offset": -1.09e-3}
    ends = {}
    for time in (0.0, 1e-6, 1e-7):
        p, x = DRIVEN.parameters.vector({**values, "chatter_time": time}), DRIVEN.state.vector(start)
        y = turn(DRIVEN, x, p, 6.34, 0.054, 200.0, gas_pressure=2e6)
        assert [x[DRIVEN.state.index(f"closed[{i}]")] for i in (1, 2, 3, 4)] == [1.0, 0.0, 0.0, 1.0]
        assert min(y["upper_front_force"], y["lower_rear_force"]) > 10.0
        ends[time] = y["last_event_time"]
        assert 0.5 * time <= ends[0.0] - ends[time] <= 2.0 * time
    piston = Instance(DRIVEN, {**values, "chatter_time": time}, start, {"gas_pressure": 2e6})
    turning = [(f"flywheel.{name}", f"piston.crank_{name}") for name in ("angle", "speed", "acceleration")]
    system = System({"flywheel": wheel(200.0, 6.34), "piston": piston}, turning)
    found = solve(system, np.array([6.34, 6.394]) / 200.0)
    assert found["piston.event_count"][-1] == y["event_count"]
    assert found["piston.last_event_time"][-1] == pytest.approx(ends[time], rel=1e-9)
    assert found["piston.lower_rear_force"][-1] == pytest.approx(y["lower_rear_force"], rel=1e-9)


def test_cutting_time_changes_no_impact():
    """The same impacts, to 1e-9 of the time, in one step and in many of any size."""
    p, rng, span = DRIVEN.parameters.vector(UNEVEN), np.random.default_rng(3), 6.0
    cuts = np.concatenate([[0.0], np.sort(rng.uniform(0.0, span, 300)), [span]])
    x, whole = DRIVEN.state.vector(), DRIVEN.state.vector()
    for start, end in itertools.pairwise(cuts):
        y = turn(DRIVEN, x, p, start, end - start, ENGINE_SPEED)
    once = turn(DRIVEN, whole, p, 0.0, span, ENGINE_SPEED)
    assert y["impact_count"] == once["impact_count"] > 10.0
    assert y["last_impact_time"] == pytest.approx(once["last_impact_time"], rel=1e-9)
    assert x == pytest.approx(whole, rel=1e-6, abs=1e-9)
    # A state that is restored goes on to the last bit.
    again = x.copy()
    y = turn(DRIVEN, x, p, span, 2.0, ENGINE_SPEED)
    assert turn(DRIVEN, again, p, span, 2.0, ENGINE_SPEED) == y
    assert np.array_equal(again, x)


def test_chatter_taken_to_its_limit_early_changes_the_motion_by_its_square():
    """Ended a time T early, trajectories differ by O(T^2)."""
    ends = []
    for time in (1e-5, 1e-6, 1e-8):
        p = DRIVEN.parameters.vector({"chatter_time": time, **UNEVEN})
        x = DRIVEN.state.vector()
        y = turn(DRIVEN, x, p, 0.0, 0.25, ENGINE_SPEED)
        ends.append(y["piston_tilt"])
    assert abs(ends[0] - ends[2]) < 1e-3 * abs(ends[2])
    assert abs(ends[1] - ends[2]) < 0.03 * abs(ends[0] - ends[2]) + 1e-12


SPEED = 150.0
SWEEPS = 400  # of the projected Gauss-Seidel; flat contact converges by 0.92 a sweep


@dataclass(frozen=True)
class Flores:
    """Their section 5; angles from the x axis, so that theta_2 = -eta."""

    r: float = FLORES["crank_radius"]
    l: float = FLORES["rod_length"]
    m1: float = FLORES["crank_mass"]
    m2: float = FLORES["rod_mass"]
    m3: float = FLORES["piston_mass"]
    j1: float = FLORES["crank_inertia"]
    j2: float = FLORES["rod_inertia"]
    j3: float = FLORES["piston_inertia"]
    a: float = FLORES["half_length"]
    b: float = FLORES["half_height"]
    clearance: float = FLORES["clearance"]
    gravity: float = 9.81

    def mass(self, q: np.ndarray) -> np.ndarray:
        mixed = (0.5 * self.m2 + self.m3) * self.r * self.l * math.cos(q[0] - q[1])
        return np.array(
            [
                [self.j1 + (0.25 * self.m1 + self.m2 + self.m3) * self.r**2, mixed, 0.0],
                [mixed, self.j2 + (0.25 * self.m2 + self.m3) * self.l**2, 0.0],
                [0.0, 0.0, self.j3],
            ]
        )

    def forces(self, q: np.ndarray, u: np.ndarray) -> np.ndarray:
        mixed = (0.5 * self.m2 + self.m3) * self.r * self.l * math.sin(q[0] - q[1])
        weight = self.gravity * np.array([0.5 * self.m1 + self.m2 + self.m3, 0.5 * self.m2 + self.m3])
        return np.array(
            [
                -mixed * u[1] ** 2 - weight[0] * self.r * math.cos(q[0]),
                mixed * u[0] ** 2 - weight[1] * self.l * math.cos(q[1]),
                0.0,
            ]
        )

    def contacts(self, q: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Gaps (4,), their gradients and those of the places along the walls (4, 3)."""
        sines, cosines = np.sin(q), np.cos(q)
        gaps, normals, tangents = [], [], []
        for side in (1.0, -1.0):
            for end in (1.0, -1.0):
                a, b = end * self.a, side * self.b
                y = self.r * sines[0] + self.l * sines[1] + a * sines[2] + b * cosines[2]
                gaps.append(self.b + self.clearance - side * y)
                turned = a * cosines[2] - b * sines[2]
                normals.append(-side * np.array([self.r * cosines[0], self.l * cosines[1], turned]))
                swung = -a * sines[2] - b * cosines[2]
                tangents.append(np.array([-self.r * sines[0], -self.l * sines[1], swung]))
        return np.array(gaps), np.array(normals), np.array(tangents)


def impulses(
    mass: np.ndarray, normals: np.ndarray, tangents: np.ndarray, free: np.ndarray, before: np.ndarray,
    restitution: float, friction: float,
) -> np.ndarray:  # fmt: skip
    """Velocities after the contact impulses, by projected Gauss-Seidel."""
    u = free.copy()
    pushes, drags = np.linalg.solve(mass, normals.T).T, np.linalg.solve(mass, tangents.T).T
    found = np.zeros((len(normals), 2))
    for _ in range(SWEEPS):
        worst = 0.0
        for i, (n, t) in enumerate(zip(normals, tangents, strict=True)):
            xi = n @ u + restitution * (n @ before)
            pressed = max(0.0, found[i, 0] - xi / (n @ pushes[i]))
            u += pushes[i] * (pressed - found[i, 0])
            bound = friction * pressed
            dragged = min(bound, max(-bound, found[i, 1] - t @ u / (t @ drags[i])))
            u += drags[i] * (dragged - found[i, 1])
            worst = max(worst, abs(pressed - found[i, 0]))
            found[i] = pressed, dragged
        if worst < 1e-15:
            break
    return u


def time_stepping(step: float, end: float, restitution: float, friction: float) -> np.ndarray:
    """(theta_1, theta_2, theta_3, rates) at `end`."""
    m = Flores()
    q, u = np.zeros(3), np.array([SPEED, -0.5 * SPEED, 0.0])
    for _ in range(round(end / step)):
        middle = q + 0.5 * step * u
        mass = m.mass(middle)
        free = u + step * np.linalg.solve(mass, m.forces(middle, u))
        gaps, normals, tangents = m.contacts(middle)
        active = gaps <= 0.0
        after = free
        if active.any():
            after = impulses(mass, normals[active], tangents[active], free, u, restitution, friction)
        q, u = middle + 0.5 * step * after, after
    return np.concatenate([q, u])


def event_driven(end: float, restitution: float, friction: float) -> tuple[np.ndarray, dict[str, float]]:
    """The same from the component."""
    p = FREE.parameters.vector({**FLORES, "restitution": restitution, "wall_friction": friction})
    y = advance(FREE, FREE.state.vector({"crank_speed": SPEED}), p, 0.0, end)
    return np.array([y["crank_angle"], -y["rod_angle"], y["piston_tilt"]]), y


@pytest.mark.parametrize(
    ("restitution", "friction", "end", "impacts"),
    [
        pytest.param(0.4, 0.01, 0.0024, 0, marks=pytest.mark.long),  # free
        (0.4, 0.01, 0.006, 4),  # two flat impacts
        pytest.param(
            0.4, 0.01, 0.012, 28, marks=pytest.mark.long
        ),  # bounced to rest, sliding on the upper wall
        pytest.param(0.1, 0.0, 0.012, 10, marks=pytest.mark.long),  # as in Siconos' time-stepping example
        pytest.param(0.4, 0.01, 0.03, 34, marks=pytest.mark.long),  # released, then on the other wall
    ],
)
def test_time_stepping_converges_to_the_event_driven_motion(restitution, friction, end, impacts, record):
    """The difference halves with the step: to within a tenth, as impacts fall anywhere in a step."""
    angles, y = event_driven(end, restitution, friction)
    assert y["impact_count"] == impacts
    errors = [
        np.abs(time_stepping(step, end, restitution, friction)[:3] - angles).max()
        for step in (2e-5, 1e-5, 5e-6)
    ]
    ratios = np.array([errors[0] / errors[1], errors[1] / errors[2]])
    quantity, source = "ratio of differences as the step is halved", "Moreau's time stepping, first order"
    record("Slider-crank", f"piston of Flores et al. (2010): {quantity}", ratios, 2.0, source, relative=0.1)
    # Extrapolated to step zero the two agree to the next order.
    assert abs(2.0 * errors[2] - errors[1]) < 0.1 * errors[2]


def test_piston_without_an_initial_tilt_stays_flat():
    """Both corners of a wall meet it together and share the impulse but for the friction's moment."""
    _, y = event_driven(0.02, 0.4, 0.01)
    for front, rear in ((1, 2), (3, 4)):
        assert y[f"corner_impact_count[{front}]"] == y[f"corner_impact_count[{rear}]"]
    assert abs(y["piston_tilt"]) < 1e-15
    assert y["corner_impact_impulse[1]"] == pytest.approx(y["corner_impact_impulse[2]"], rel=0.02)


def test_start_of_the_source_is_the_aligned_mechanism(record):
    """theta_2' = -75 rad/s at 150 rad/s: the piston does not move across the bore."""
    named = outputs_of(FREE, FLORES, {"crank_speed": SPEED})
    quantity, source = "piston of Flores et al. (2010): position at the start (m)", "data of the source"
    record("Slider-crank", quantity, named["piston_position"], 0.459, source, relative=1e-15)
    assert named["piston_velocity"] == named["piston_offset_rate"] == 0.0
