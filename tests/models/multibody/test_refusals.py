"""What is no mechanism, or no motion, is refused by name."""

import math

import numpy as np
import pytest

from models.core.errors import ModelError
from models.multibody.bodies import Body
from models.multibody.forces import SpringDamper, beam_stiffness, rod_rate
from models.multibody.ida import solve_ida
from models.multibody.joints import (
    LeverEnd,
    cylindrical,
    fixed,
    plane_contact,
    prescribed_rotation,
    revolute,
    spherical,
    support,
)
from models.multibody.mechanism import Mechanism

from .projected import solve_projected

INERTIA, RADIUS = (1e-4, 1e-3, 1e-3), 0.025
GRAVITY = (0.0, -9.81, 0.0)


def ball(name: str = "ball", **start) -> Body:
    return Body(name, 1.0, (1e-2,) * 3, **start)


WELD = fixed("weld", "ground", "ball")
FALLING = Mechanism([ball()], [], gravity=GRAVITY)
BEAM = {"length": 0.1, "diameter": 0.02, "youngs_modulus": 207e9, "poissons_ratio": 0.3}
ROD = {"youngs_modulus": 207e9, "area": 5e-5, "length": 0.2}


def crank(angle: float, begin: float) -> Mechanism:
    body = Body("crank", 0.5, INERTIA, position=(RADIUS, 0.0, 0.0), angles=(0.0, 0.0, begin))
    joints = [
        revolute("main", "ground", "crank", at_j=(-RADIUS, 0.0, 0.0)),
        prescribed_rotation("drive", "ground", "crank", 100.0, angle=angle),
    ]
    return Mechanism([body], joints)


@pytest.mark.parametrize("angle", [1.5, 3.0, -2.5])
def test_a_drive_finds_its_angle_or_says_that_the_start_is_too_far(angle):
    """From a start within 90 degrees the place is r (cos, sin); a half turn off is no solution."""
    found = crank(angle, 0.7 * angle).start().q[:2]
    np.testing.assert_allclose(found, RADIUS * np.array([math.cos(angle), math.sin(angle)]), atol=1e-12)
    if abs(angle) > 0.5 * math.pi:
        with pytest.raises(ModelError, match="joint drive: crank is put together half a turn"):
            crank(angle, 0.0).start()


def driven_twice(speed: float = 10.0, angle: float = 0.0, acceleration: float = 0.0) -> Mechanism:
    """A second drive beside one of 10 rad/s from 0."""
    motions = {"drive": (10.0,), "other": (speed, angle, acceleration)}
    drives = [prescribed_rotation(name, "ground", "ball", *motion) for name, motion in motions.items()]
    return Mechanism([ball()], [revolute("main", "ground", "ball"), *drives])


def parallelogram(angle: float, speed: float = 10.0, arm: float = 0.1, rod: float = 0.3) -> Mechanism:
    """Two equal cranks on a coupler; where all stand in one line it may go on as an antiparallelogram."""
    pin = np.array([arm * math.cos(angle), arm * math.sin(angle), 0.0])
    along = np.array([rod, 0.0, 0.0])
    turning = {"angles": (0.0, 0.0, angle), "angular_velocity": (0.0, 0.0, speed)}
    bodies = [
        Body("crank", 1.0, INERTIA, tuple(0.5 * pin), **turning),
        Body("coupler", 1.0, INERTIA, tuple(pin + 0.5 * along)),
        Body("rocker", 1.0, INERTIA, tuple(along + 0.5 * pin), **turning),
    ]
    half, end = (0.5 * arm, 0.0, 0.0), (0.5 * rod, 0.0, 0.0)
    back, start = (-0.5 * arm, 0.0, 0.0), (-0.5 * rod, 0.0, 0.0)
    joints = [
        revolute("main", "ground", "crank", at_j=back),
        cylindrical("pin", "crank", "coupler", at_i=half, at_j=start),
        revolute("pivot", "ground", "rocker", at_i=tuple(along), at_j=back),
        support("other pin", "coupler", "rocker", at_i=end, at_j=half),
        prescribed_rotation("drive", "ground", "crank", speed, angle),
    ]
    return Mechanism(bodies, joints)


def test_a_change_point_is_refused_with_the_joint_and_the_angle():
    """At pi; before it the cranks stay parallel."""
    angle = 3.1
    times = np.linspace(0.0, 0.95 * (math.pi - angle) / 10.0, 5)
    motion = solve_projected(parallelogram(angle), times)
    parallel = motion.angles("crank")[:, 2] - motion.angles("rocker")[:, 2]
    assert np.max(np.abs(parallel)) < 1e-9
    with pytest.raises(ModelError, match=r"two ways, at .* drive angle 3\.1415\d* rad: other pin: along"):
        solve_projected(parallelogram(angle), np.array([0.0, 0.4]))


def test_lengths_of_axes_make_no_difference():
    """The load under a weight is m g."""
    contact = plane_contact("floor", "ground", "ball", normal=(0.0, 2.0, 0.0))
    mechanism = Mechanism([ball()], [contact], gravity=GRAVITY)
    assert abs(mechanism.start().multipliers[0]) == pytest.approx(9.81, rel=1e-12)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (
            lambda: Mechanism([ball(angles=(0.0, 0.0, 2.0))], [WELD]).start(),
            "joint weld: ball is put together half a turn",
        ),
        *(
            (
                lambda second=second: driven_twice(*second).start(),
                "redundant constraints: other: turning.*drive",
            )
            for second in ((), (20.0,), (10.0, 0.0, 5.0))
        ),
        (lambda: driven_twice(10.0, 0.3).start(), "drive angle 0 rad, 0.3 rad: .*drives that contradict"),
        (
            lambda: Mechanism([ball()], [WELD, spherical("pin", "ground", "ball")]).start(),
            "pin: along x; pin: along y; pin: along z",
        ),
        (
            lambda: Mechanism([ball()], [spherical("pin", "ground", "piston")]).start(),
            "no body 'piston'; there are ground, ball",
        ),
        (lambda: crank(0.0, 0.0).find_joint("pin"), "no joint 'pin'; there are main, drive"),
        (lambda: Body("rod", -1.0, INERTIA), "body rod: mass = -1 kg .* must be positive"),
        (
            lambda: solve_ida(
                Mechanism([ball()], [], [SpringDamper("ground", "ball", 1.0, 0.0)]), [0.0, 1.0]
            ),
            "look at the force elements",
        ),
        (lambda: Mechanism([], []), "at least one body"),
        (lambda: Mechanism([ball("a"), ball("a")], []), "body a: there are two"),
        (lambda: Mechanism([ball()], [], gravity=(0.0, -9.81)), "gravity = .*three finite numbers"),
        (lambda: ball(position=(math.nan, 0.0, 0.0)), "ball: position = .*three finite numbers"),
        (lambda: plane_contact("p", "ground", "ball", normal=(0.0, 0.0, 0.0)), "has no direction"),
        (lambda: prescribed_rotation("d", "ground", "ball", math.nan), "joint d: .*must be finite"),
        (
            lambda: beam_stiffness(**BEAM | {"youngs_modulus": 207.0}),
            r"youngs_modulus = 207 Pa .*: must be >= 100000 and <= 1e\+13",
        ),
        (lambda: beam_stiffness(**BEAM | {"poissons_ratio": 0.6}), "must be >= -0.99 and <= 0.5"),
        *(
            (lambda times=times: solve_ida(FALLING, times), "times: must be")
            for times in ([0.0], [0.0, 0.0], [0.0, math.nan])
        ),
        (lambda: solve_ida(FALLING, [0.0, 1.0], math.nan), "tolerance = nan: must be from"),
    ],
)
def test_mistakes_are_named(make, message):
    with pytest.raises(ModelError, match=message):
        make()


@pytest.mark.parametrize("wrong", [-1.0, math.nan])
@pytest.mark.parametrize(
    ("make", "thing", "names"),
    [
        (lambda **v: beam_stiffness(**{**BEAM, **v}), "beam", [*BEAM, "shear_factor"]),
        (lambda **v: rod_rate(**ROD | v), "rod", [*ROD]),
        (lambda **v: LeverEnd(**{"arm": 0.03} | v), "lever's end", ["arm", "radius"]),
        (
            lambda **v: SpringDamper("ground", "ball", **{"stiffness": 1.0, "length": 0.1} | v),
            "spring between ground and ball", ["stiffness", "damping"],
        ),
    ],
)  # fmt: skip
def test_values_out_of_range_are_named(make, thing, names, wrong):
    for name in names:
        with pytest.raises(ModelError, match=f"^{thing}: {name} = .*: must be .*; give it in SI units$"):
            make(**{name: wrong})
