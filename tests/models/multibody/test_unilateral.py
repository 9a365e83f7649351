"""Bodies between walls: the slider-crank with clearance against its exact flights, and a bouncing ball."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import cache
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, reject, settings
from hypothesis import strategies as st

from models.core.system import ModelError
from models.multibody.bodies import Body
from models.multibody.joints import prescribed_rotation, revolute
from models.multibody.mechanism import Mechanism
from models.multibody.unilateral import Bounced, Wall, share_impulses, solve_bouncing
from models.slider_crank import forms

from ..slider_cranks import CRANK, ROLLER, thesis_parameters, turn

CLEARANCE, RESTITUTION = 0.02, 0.9
# At 0.4 per radian, errors grow 150 times in two turns.
TIMES = np.linspace(0.0, 4.0 * math.pi, 241)


def build_slider_crank() -> Mechanism:
    """Farahanchi's engine with M = l = 1 at unit speed, without friction: crank, rod and roller."""
    radius, rod = ROLLER["crank_radius"], ROLLER["rod_mass"]
    turning = -radius  # of the rod, whose angle below the axis grows with xi sin theta
    bodies = [
        Body("crank", 1.0, (1.0, 1.0, 1.0), angular_velocity=(0.0, 0.0, 1.0)),
        Body(
            "rod", rod, (1.0, 1.0, ROLLER["rod_inertia"]), (radius + 0.5, 0.0, 0.0),
            velocity=(0.0, radius + 0.5 * turning, 0.0), angular_velocity=(0.0, 0.0, turning),
        ),
        Body("roller", 1.0, (1.0, 1.0, 1.0), (radius + 1.0, 0.0, 0.0)),
    ]  # fmt: skip
    joints = [
        revolute("main bearing", "ground", "crank"),
        prescribed_rotation("drive", "ground", "crank", 1.0),
        revolute("crank pin", "crank", "rod", at_i=(radius, 0.0, 0.0), at_j=(-0.5, 0.0, 0.0)),
        revolute("wrist pin", "rod", "roller", at_i=(0.5, 0.0, 0.0)),
    ]
    return Mechanism(bodies, joints)


def list_walls(restitution: float = RESTITUTION) -> list[Wall]:
    return [
        Wall(name, "roller", (0.0, side, 0.0), CLEARANCE, restitution)
        for name, side in (("upper", -1.0), ("lower", 1.0))
    ]


@cache
def bounced() -> Bounced:
    return solve_bouncing(build_slider_crank(), list_walls(), TIMES)


def test_flights_and_impacts_are_those_of_the_exact_flights(record: Callable[..., None]) -> None:
    """Two turns of the crank: offset, torque, impacts and impulses against power series of the pendulum."""
    p = thesis_parameters(0.0, CLEARANCE, form=forms.NONLINEAR, restitution=RESTITUTION)
    x, exact = CRANK.state.vector(), []
    for one, other in pairwise(TIMES):
        exact.append(turn(CRANK, x, p, float(one), float(other - one)))
    motion, impacts = bounced()
    offset = motion.position("roller")[1:, 1]
    error = np.max(np.abs(offset - [y["piston_offset"] for y in exact])) / CLEARANCE
    record(
        "Multibody", "slider-crank with clearance: offset, error over the clearance", error, 0.0,
        "exact flights", tolerance=1e-5,
    )  # fmt: skip
    torque = np.array([y["crank_torque"] for y in exact])
    error = np.max(np.abs(motion.multiplier("drive")[1:, 0] - torque)) / np.max(np.abs(torque))
    record(
        "Multibody", "slider-crank with clearance: torque, error over largest", error, 0.0, "exact flights",
        tolerance=1e-6,
    )  # fmt: skip
    last = exact[-1]
    assert len(impacts) == last["impact_count"] > 5
    assert sum(hit.wall == "upper" for hit in impacts) == last["upper_impact_count"]
    for wall in ("upper", "lower"):
        total = sum(hit.impulse for hit in impacts if hit.wall == wall)
        assert total == pytest.approx(last[f"{wall}_impact_impulse"], rel=1e-5)
    record(
        "Multibody", "slider-crank with clearance: time of the last impact (s)", impacts[-1].time,
        last["last_impact_time"], "exact flights", tolerance=1e-6,
    )  # fmt: skip
    assert max(motion.drift) < 1e-9


def test_impulses_are_those_of_the_effective_mass() -> None:
    """P = (1 + e) v a/cos^2(eta), a = alpha/4 + 1 + beta, which turning crank and joints do not change."""
    inertia = 0.25 * ROLLER["rod_mass"] + 1.0 + ROLLER["rod_inertia"]
    for hit in bounced().impacts:
        y = CLEARANCE if hit.wall == "upper" else -CLEARANCE
        sine = ROLLER["crank_radius"] * math.sin(hit.time) - y
        mass = inertia / (1.0 - sine * sine)
        assert hit.impulse == pytest.approx((1.0 + RESTITUTION) * hit.closing * mass, rel=1e-9)


def test_a_ball_bounces_as_in_closed_form() -> None:
    """Dropped from 1 m with e = 0.8: bounces at sqrt(2/g) (1 + 2 e + 2 e^2 ...), impulse m (1 + e) v."""
    ball = Mechanism([Body("ball", 2.0, (1.0, 1.0, 1.0), (0.0, 1.0, 0.0))], [], gravity=(0.0, -9.81, 0.0))
    wall = Wall("floor", "ball", (0.0, 1.0, 0.0), 0.0, 0.8)
    _, impacts = solve_bouncing(ball, [wall], np.linspace(0.0, 2.0, 21))
    fall, speed = math.sqrt(2.0 / 9.81), math.sqrt(2.0 * 9.81)
    times = [fall * (1.0 + 2.0 * sum(0.8**j for j in range(1, k + 1))) for k in range(len(impacts))]
    assert len(impacts) == 3
    assert [hit.time for hit in impacts] == pytest.approx(times, rel=1e-9)
    impulses = [2.0 * 1.8 * speed * 0.8**k for k in range(len(impacts))]
    assert [hit.impulse for hit in impacts] == pytest.approx(impulses, rel=1e-8)


@pytest.mark.parametrize("gap", [5e-11, -5e-11])
def test_a_ball_that_begins_at_a_wall_bounces_at_once(gap: float) -> None:
    """It lands again after 2 e v/g."""
    ball = Body("ball", 2.0, (1.0, 1.0, 1.0), (0.0, gap, 0.0), velocity=(0.0, -1.0, 0.0))
    floor = Wall("floor", "ball", (0.0, 1.0, 0.0), 0.0, 0.8)
    mechanism = Mechanism([ball], [], gravity=(0.0, -9.81, 0.0))
    _, impacts = solve_bouncing(mechanism, [floor], np.linspace(0.0, 0.2, 3))
    assert [hit.time for hit in impacts] == pytest.approx([0.0, 1.6 / 9.81], abs=1e-9)
    assert [hit.closing for hit in impacts] == pytest.approx([1.0, 0.8], rel=1e-8)


GRAVITY, FOOT = 9.81, 0.5


def drop_stick(
    height: float, inertia: float, restitution: tuple[float, float], end: float, angle: float = 0.0
) -> Bounced:
    """A stick of 1 kg falls on a foot at each end."""
    stick = Body("stick", 1.0, (1e-3, inertia, inertia), (0.0, height, 0.0), (0.0, 0.0, angle))
    feet = [
        Wall(name, "stick", (0.0, 1.0, 0.0), 0.0, e, at=(at, 0.0, 0.0))
        for name, at, e in zip(("left", "right"), (-FOOT, FOOT), restitution, strict=True)
    ]
    mechanism = Mechanism([stick], [], gravity=(0.0, -GRAVITY, 0.0))
    return solve_bouncing(mechanism, feet, np.linspace(0.0, end, 9))


@pytest.mark.parametrize(("height", "inertia"), [(0.1, 1.0), (0.5, 0.01)])
def test_a_level_stick_lands_on_both_feet_at_once(height: float, inertia: float) -> None:
    """It bounces as a ball, each foot with half of its impulse, and does not turn."""
    fall, speed, e = math.sqrt(2.0 * height / GRAVITY), math.sqrt(2.0 * GRAVITY * height), 0.5
    motion, impacts = drop_stick(height, inertia, (e, e), 2.6 * fall)
    assert [hit.wall for hit in impacts] == ["left", "right"] * 3
    for k, hits in enumerate(zip(impacts[::2], impacts[1::2], strict=True)):
        time = fall * (1.0 + 2.0 * sum(e**j for j in range(1, k + 1)))
        for hit in hits:
            assert hit.time == pytest.approx(time, rel=1e-9)
            assert hit.impulse == pytest.approx(0.5 * (1.0 + e) * speed * e**k, rel=1e-8)
    assert np.max(np.abs(motion.angles("stick"))) < 1e-10


@settings(max_examples=6)
@given(
    height=st.floats(0.3, 1.0),
    inertia=st.floats(0.02, 1.0),
    angle=st.sampled_from([0.0, 1e-11, -1e-9, 1e-6, 0.01, -0.2]),
    restitution=st.tuples(st.floats(0.3, 1.0), st.floats(0.3, 1.0)),
)
def test_impacts_keep_momentum_and_add_no_energy(
    height: float, inertia: float, angle: float, restitution: tuple[float, float]
) -> None:
    """m v' = P - m g t and I w' = sum of r P, at any angle at which the feet land."""
    end = 1.1 * math.sqrt(2.0 * height / GRAVITY)
    try:
        motion, impacts = drop_stick(height, inertia, restitution, end, angle)
    except ModelError:  # one foot comes to rest while the other flies: not followed
        reject()
    v, turned, y = motion.v[-1], motion.angles("stick")[-1, 2], motion.position("stick")[-1, 1]
    assert sum(hit.impulse for hit in impacts) == pytest.approx(v[1] + GRAVITY * end, abs=1e-8)
    turn, last, spin = angle, 0.0, 0.0
    for hit in impacts:
        turn, last = turn + spin * (hit.time - last), hit.time
        arm = -FOOT if hit.wall == "left" else FOOT
        spin += arm * math.cos(turn) * hit.impulse / inertia
    assert spin == pytest.approx(v[5], abs=1e-7)
    assert turn + spin * (end - last) == pytest.approx(turned, abs=1e-8)
    energy = 0.5 * v[1] ** 2 + 0.5 * inertia * v[5] ** 2 + GRAVITY * y
    assert impacts
    assert energy <= GRAVITY * height * (1.0 + 1e-9)
    assert min(y - FOOT * abs(math.sin(turned)), 0.0) > -1e-9


@given(
    entries=st.lists(st.floats(-1.0, 1.0), min_size=9, max_size=9),
    change=st.lists(st.floats(0.1, 2.0), min_size=3, max_size=3),
)
def test_impulses_only_push_and_only_where_they_are_needed(entries: list[float], change: list[float]) -> None:
    """P >= 0, W P >= c and P (W P - c) = 0."""
    factor, wanted = np.reshape(entries, (3, 3)), np.array(change)
    admittance = factor @ factor.T + 0.1 * np.eye(3)
    impulses = share_impulses(admittance, wanted)
    left = admittance @ impulses - wanted
    assert np.min(impulses) >= 0.0
    assert np.min(left) > -1e-9
    np.testing.assert_allclose(impulses * left, 0.0, atol=1e-8)


def test_what_cannot_be_followed_is_refused_with_the_wall() -> None:
    ball = Mechanism([Body("ball", 2.0, (1.0, 1.0, 1.0), (0.0, 1.0, 0.0))], [], gravity=(0.0, -9.81, 0.0))
    floor, times = Wall("floor", "ball", (0.0, 1.0, 0.0), 0.0, 0.2), np.linspace(0.0, 2.0, 3)
    with pytest.raises(ModelError, match=r"wall floor: bounces of ball at t = 0\.6.* become too short"):
        solve_bouncing(ball, [floor], times)
    with pytest.raises(ModelError, match=r"wall roof: body ball begins 0\.5 m beyond it"):
        solve_bouncing(ball, [Wall("roof", "ball", (0.0, -1.0, 0.0), 0.5, 0.2)], times)
    with pytest.raises(ModelError, match=r"wall floor: restitution = 1\.2 must be from 0 to 1"):
        Wall("floor", "ball", (0.0, 1.0, 0.0), 0.0, 1.2)
