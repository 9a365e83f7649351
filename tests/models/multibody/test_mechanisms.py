"""Mechanisms with a known motion, by both methods; and those that cannot be built."""

import math
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.special import ellipk

from models.core.system import ModelError
from models.multibody.bodies import Body
from models.multibody.forces import SpringDamper
from models.multibody.ida import solve_ida
from models.multibody.joints import Joint, cylindrical, prescribed_rotation, revolute, spherical
from models.multibody.mechanism import Mechanism

from .projected import solve_projected

METHODS = {"IDA": solve_ida, "projected DOP853": solve_projected}
G = 9.81
CRANK, ROD, SPEED = 0.05, 0.15, 100.0
SLIDER_MASS, ROD_MASS, ROD_INERTIA = 0.4, 0.3, 1.1e-3


@pytest.mark.parametrize("method", METHODS.values(), ids=METHODS)
def test_period_of_a_pendulum_is_the_elliptic_integral(method, record):
    """4 K(sin^2(phi/2)) sqrt(I/(m g L)) from rest at phi = 120 deg; it is back where it began."""
    arm, mass, inertia, phi = 0.3, 0.5, 2e-3, math.radians(120.0)
    place = (arm * math.sin(phi), -arm * math.cos(phi), 0.0)
    bob = Body("bob", mass, (inertia, inertia, inertia), place, (0.0, 0.0, phi))
    pendulum = Mechanism(
        [bob], [revolute("pin", "ground", "bob", at_j=(0.0, arm, 0.0))], gravity=(0.0, -G, 0.0)
    )
    total = inertia + mass * arm**2
    period = 4.0 * ellipk(math.sin(0.5 * phi) ** 2) * math.sqrt(total / (mass * G * arm))
    motion = method(pendulum, np.linspace(0.0, period, 401))
    back = motion.angles("bob")[-1, 2] / phi
    quantity = "pendulum after its period: angle over first angle"
    record("Multibody", quantity, back, 1.0, "elliptic integral", tolerance=1e-6)
    # The pin carries m g cos + m L phi'^2 along the rod, and no moment about itself.
    angle, rate, pin = motion.angles("bob")[:, 2], motion.v[:, 5], motion.reaction("pin")
    pull = np.sum(pin.force[:, :2] * np.stack([-np.sin(angle), np.cos(angle)], 1), axis=1)
    np.testing.assert_allclose(pin.moment[:, 2], 0.0, atol=1e-9)
    np.testing.assert_allclose(pull, mass * (G * np.cos(angle) + arm * rate**2), atol=1e-6)


def spinning_top(tilt: float, spin: float, precession: float) -> Mechanism:
    """A symmetric top on a point; its axis is z, so that beta stays within the tilt."""
    arm, direction = 0.1, np.array([math.sin(tilt), 0.0, math.cos(tilt)])
    omega = np.array([0.0, 0.0, precession]) + spin * direction
    top = Body(
        "top", 1.0, (2e-3, 2e-3, 1e-3), tuple(arm * direction), (0.0, tilt, 0.0),
        tuple(np.cross(omega, arm * direction)), tuple(omega),
    )  # fmt: skip
    return Mechanism(
        [top], [spherical("tip", "ground", "top", at_j=(0.0, 0.0, -arm))], gravity=(0.0, 0.0, -G)
    )


@pytest.mark.parametrize("method", METHODS.values(), ids=METHODS)
def test_a_top_precesses_steadily_at_the_rate_of_eulers_equations(method):
    """C (s + p cos) p - A p^2 cos = m g L, A and C about the tip: its tilt stays."""
    tilt, precession, arm = 0.5, 6.0, 0.1
    a, c = 2e-3 + 1.0 * arm**2, 1e-3
    spin = (G * arm / precession + a * precession * math.cos(tilt)) / c - precession * math.cos(tilt)
    motion = method(spinning_top(tilt, spin, precession), np.linspace(0.0, 0.5, 51))
    place = motion.position("top")
    np.testing.assert_allclose(place[:, 2], arm * math.cos(tilt), atol=1e-8)
    turned = np.unwrap(np.arctan2(place[:, 1], place[:, 0]))
    np.testing.assert_allclose(turned, precession * motion.times, atol=1e-6)


def slider_crank(
    rod: float = ROD, angle: float = 0.0, pin_joint: Callable[..., Joint] = cylindrical
) -> Mechanism:
    """Crank, rod and slider along x, driven at constant speed; the slider may turn about its axis."""
    pin = (CRANK * math.cos(angle), CRANK * math.sin(angle), 0.0)
    lean = math.asin(max(-1.0, min(1.0, pin[1] / rod)))
    end = (pin[0] + rod * math.cos(lean), 0.0, 0.0)
    middle = tuple(0.5 * (a + b) for a, b in zip(pin, end, strict=True))
    crank_middle = (0.5 * pin[0], 0.5 * pin[1], 0.0)
    bodies = [
        Body("crank", 0.5, (1e-4, 1e-3, 1e-3), crank_middle, (0.0, 0.0, angle)),
        Body("rod", ROD_MASS, (1e-5, ROD_INERTIA, ROD_INERTIA), middle, (0.0, 0.0, -lean)),
        Body("slider", SLIDER_MASS, (1e-4, 1e-4, 1e-4), end),
    ]
    x = (1.0, 0.0, 0.0)
    joints = [
        revolute("main bearing", "ground", "crank", at_j=(-0.5 * CRANK, 0.0, 0.0)),
        pin_joint("crank pin", "crank", "rod", at_i=(0.5 * CRANK, 0.0, 0.0), at_j=(-0.5 * rod, 0.0, 0.0)),
        spherical("wrist pin", "rod", "slider", at_i=(0.5 * rod, 0.0, 0.0)),
        cylindrical("cylinder", "ground", "slider", axis_i=x, axis_j=x),
        prescribed_rotation("drive", "ground", "crank", SPEED, angle),
    ]
    return Mechanism(bodies, joints)


def crank_torque(angle: np.ndarray) -> np.ndarray:
    """dE/dtheta of the kinetic energy at constant speed, by complex steps: r cos + sqrt(l^2 - r^2 sin^2)."""

    def energy(theta: np.ndarray) -> np.ndarray:
        sine = CRANK / ROD * np.sin(theta)
        cosine = np.sqrt(1.0 - sine**2)
        lean = CRANK / ROD * np.cos(theta) / cosine  # d(lean)/d(theta)
        slider = -CRANK * np.sin(theta) - ROD * sine * lean
        along, across = -CRANK * np.sin(theta) - 0.5 * ROD * sine * lean, 0.5 * CRANK * np.cos(theta)
        moving = SLIDER_MASS * slider**2 + ROD_MASS * (along**2 + across**2) + ROD_INERTIA * lean**2
        return 0.5 * SPEED**2 * moving

    return np.imag(energy(angle + 1e-30j)) / 1e-30


@pytest.mark.parametrize("method", METHODS.values(), ids=METHODS)
def test_slider_crank_moves_and_loads_its_drive_as_the_closed_form(method, record):
    times = np.linspace(0.0, 2.0 * math.pi / SPEED, 73)
    motion = method(slider_crank(angle=0.3), times)
    angle = SPEED * times + 0.3
    place = CRANK * np.cos(angle) + np.sqrt(ROD**2 - (CRANK * np.sin(angle)) ** 2)
    np.testing.assert_allclose(motion.position("slider")[:, 0], place, atol=1e-9)
    exact = crank_torque(angle)
    error = np.max(np.abs(motion.multiplier("drive")[:, 0] - exact)) / np.max(np.abs(exact))
    record("Multibody", "slider-crank: error of the drive torque", error, 0.0, "closed form", tolerance=1e-6)
    assert max(motion.drift) < 1e-7


@pytest.mark.parametrize("method", [solve_ida, pytest.param(solve_projected, marks=pytest.mark.long)])
def test_energy_of_bodies_on_springs_is_kept(method):
    """A body hung in three springs tumbles: kinetic energy, weight and k e^2/2 add up to what they were."""
    body = Body(
        "body", 0.8, (1e-3, 2e-3, 2.5e-3), (0.1, 0.05, -0.1), (0.2, -0.3, 0.1), (0.3, 0.0, -0.2),
        (3.0, -2.0, 4.0),
    )  # fmt: skip
    ends = [((1.0, 0.0, 0.0), (0.1, 0.0, 0.0)), ((0.0, 1.0, 0.0), (0.0, 0.1, 0.0)),
            ((-1.0, -1.0, 1.0), (0.0, 0.0, 0.1))]  # fmt: skip
    springs = [SpringDamper("ground", "body", 200.0, 0.5, at_i=i, at_j=j) for i, j in ends]
    system = Mechanism([body], [], springs, gravity=(0.0, 0.0, -G))
    motion = method(system, np.linspace(0.0, 1.0, 101), 1e-10)
    found = []
    for q, v in zip(motion.q, motion.v, strict=True):
        e = system.evaluate(0.0, q, v)
        lengths = [np.linalg.norm(q[:3] + e.rotation[1] @ j - i) for i, j in ends]
        stored = 100.0 * sum((length - 0.5) ** 2 for length in lengths)
        found.append(0.5 * v @ e.mass @ v + 0.8 * G * q[2] + stored)
    np.testing.assert_allclose(found, found[0], rtol=3e-8)


def test_freedoms_are_counted_and_redundant_constraints_named():
    """The slider may turn; main bearing, crank pin and cylinder need not all hold the rod along z."""
    assert slider_crank().freedoms == 1
    with pytest.raises(ModelError, match=r"redundant constraints: cylinder: along first axis.*hold less"):
        slider_crank(pin_joint=revolute).start()


@pytest.mark.parametrize("method", METHODS.values(), ids=METHODS)
def test_a_rod_shorter_than_its_crank_is_named_with_the_angle(method):
    """It cannot be assembled at 90 deg, and locks at sin(theta) = l/r = 0.8, theta = 0.9273."""
    with pytest.raises(
        ModelError, match=r"cannot be assembled at t = 0 s, drive angle 1\.5708 rad: .*look at the lengths"
    ):
        slider_crank(rod=0.04, angle=0.5 * math.pi).start()
    with pytest.raises(
        ModelError, match=r"at t = 0\.0092[67]\d* s, drive angle 0\.92[67]\d* rad: .* cannot be held"
    ):
        method(slider_crank(rod=0.04), np.linspace(0.0, 0.012, 13))


def test_the_mechanism_of_twenty_lines_in_the_documents_runs(capsys):
    page = (Path(__file__).parents[3] / "docs" / "theory" / "multibody.md").read_text("utf-8")
    (code,) = re.findall(r"```python\n(.+?)```", page, re.DOTALL)
    names: dict[str, Any] = {}
    exec(code, names)
    angle = SPEED * names["motion"].times
    place = CRANK * np.cos(angle) + np.sqrt(ROD**2 - (CRANK * np.sin(angle)) ** 2)
    np.testing.assert_allclose(names["motion"].position("piston")[:, 0], place, atol=1e-9)
    assert capsys.readouterr().out
