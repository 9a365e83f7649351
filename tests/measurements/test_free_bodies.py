"""Benchmarks of multibody codes: a crank that a torque turns, and a heavy top."""

import numpy as np

from models.multibody.bodies import Body, X
from models.multibody.ida import solve_ida
from models.multibody.joints import cylindrical, revolute, spherical
from models.multibody.mechanism import Mechanism

from .page import COMPUTED, Published

CRANK, ROD = 0.1, 0.3


def rod(name: str, mass: float, length: float, middle: float, torque: float = 0.0) -> Body:
    """A uniform rod along x."""
    inertia = mass * length**2 / 12.0
    place = (middle, 0.0, 0.0)
    return Body(name, mass, (1e-2 * inertia, inertia, inertia), place, moment=(0.0, 0.0, torque))


def driven_crank() -> Mechanism:
    """From rest, stretched along x."""
    bodies = [
        rod("crank", 0.2, CRANK, 0.5 * CRANK, torque=0.1),
        rod("rod", 0.2, ROD, CRANK + 0.5 * ROD),
        Body("slider", 0.4, (1e-4,) * 3, (CRANK + ROD, 0.0, 0.0)),
    ]
    half, far = (0.5 * CRANK, 0.0, 0.0), (0.5 * ROD, 0.0, 0.0)
    joints = [
        revolute("main bearing", "ground", "crank", at_j=(-0.5 * CRANK, 0.0, 0.0)),
        cylindrical("crank pin", "crank", "rod", at_i=half, at_j=(-0.5 * ROD, 0.0, 0.0)),
        spherical("wrist pin", "rod", "slider", at_i=far),
        cylindrical("guide", "ground", "slider", axis_i=X, axis_j=X),
    ]
    return Mechanism(bodies, joints)


def test_a_torque_turns_a_slider_crank(published) -> None:
    times = np.concatenate([np.linspace(0.0, 2.999, 31), np.linspace(2.9991, 3.001, 20)])
    motion = solve_ida(driven_crank(), times, 1e-8)
    angle, speed = motion.angles("crank")[:, 2], motion.v[:, 5]
    rows = (
        ("angle of the crank at 3 s (rad)", float(np.interp(3.0, times, angle)), 121.89082,
         "19 revolutions; the energy of the published pair misses the work of the torque by 1e-4"),
        ("its speed at the published angle (rad/s)", float(np.interp(121.89082, angle, speed)), 101.69399,
         "at one angle the speed follows from the work of the torque"),
    )  # fmt: skip
    for quantity, ours, value, why in rows:
        case = Published(
            "Mechanisms", f"slider-crank under 0.1 N m: {quantity}",
            "0.1 and 0.3 m, 0.2, 0.2 and 0.4 kg, from rest; band: 1e-4, of a solution with steps to 1e-6",
            COMPUTED, value * (1.0 - 1e-4), value * (1.0 + 1e-4),
            "Exudyn, sliderCrankFloatingTest with its MATLAB reference (J. Gerstmayr, 2019)", value, digits=7,
        )  # fmt: skip
        published(case, ours, why)


def test_a_heavy_top_nutates(published) -> None:
    """Its axis is z here and y in the source; gravity pulls along -x."""
    across, polar, mass = 0.234375, 0.46875, 15.0
    omega = np.array([-4.61538, 0.0, 150.0])
    top = Body(
        "top", mass, (across, across, polar), (0.0, 0.0, 1.0),
        velocity=tuple(np.cross(omega, [0.0, 0.0, 1.0])), angular_velocity=tuple(omega),
    )  # fmt: skip
    tip = spherical("tip", "ground", "top", at_j=(0.0, 0.0, -1.0))
    mechanism = Mechanism([top], [tip], gravity=(-9.81, 0.0, 0.0))
    motion = solve_ida(mechanism, np.linspace(0.0, 0.06, 7), 1e-9)
    e = mechanism.evaluate(0.06, motion.q[-1], motion.v[-1])
    found = e.rotation[1].T @ motion.v[-1, 3:]
    for axis, ours, value in (("x", found[1], 3.4673), ("z", found[0], 3.216)):
        case = Published(
            "Mechanisms", f"heavy top: angular velocity about its own {axis} axis at 0.06 s (rad/s)",
            "15 kg at 1 m from the tip, spin 150, across 4.61538 rad/s; band: 2 units of the last digit",
            COMPUTED, value - 2e-4, value + 2e-4,
            "Brüls and Cardona (2010), doi:10.1115/1.4001370; solution of 4th order in Exudyn's documents",
            value, digits=5,
        )  # fmt: skip
        published(case, ours, "no closed form: nutation of a top whose axis is not steady")
