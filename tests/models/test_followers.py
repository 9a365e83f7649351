"""Followers on the shape of a cam, against independent numbers, round trips and virtual work."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import brentq

from models.valve_train.cams.law import law_lift
from models.valve_train.cams.table import table_lift
from models.valve_train.camshaft import camshaft
from models.valve_train.followers.mechanisms import (
    Finger,
    Flat,
    Translating,
    move_finger,
    touch_finger,
    touch_translating,
    turn_finger,
)
from models.valve_train.followers.shape import FOLLOWERS, sample_angles, trace_shape

CAM = camshaft().parameters.defaults()
R0, WIDE = CAM.base_radius, CAM.dwell_half_width + CAM.rise_angle
BREAKS = [math.pi + side * half for side in (-1.0, 1.0) for half in (WIDE, CAM.dwell_half_width)]
ANGLES = sample_angles(720, BREAKS)
FLAT = Flat(R0)
ROLLER = Translating(R0, 10e-3, 0.0)
FINGER = Finger(R0, 20e-3, 28e-3, math.radians(8.0), 40e-3, math.radians(2.0))
EVALUATION = "independent evaluation"


def flat_lift(angle):
    return law_lift(angle, CAM)


def through(points):
    """The lift between points."""
    component = camshaft(table_points=points.angle.size)
    record = component.parameters.view(component.parameters.vector(points.parameters()))
    return lambda angle: table_lift(angle, record)


def on_the_flat_cam(kind, geometry):
    """The lift of a follower on the cam of the set `kushwaha2000`."""
    shape = trace_shape(ANGLES, flat_lift, FOLLOWERS["flat"], FLAT)
    return through(FOLLOWERS[kind].follow(shape, geometry))


@pytest.fixture(scope="module")
def roller_lift():
    return on_the_flat_cam("roller", ROLLER)


@pytest.fixture(scope="module")
def finger_lift():
    return on_the_flat_cam("finger_pad", FINGER)


# Lift (mm), its derivatives (mm/rad), pressure angle (deg), entraining velocity / speed (mm).
ROLLER_NUMBERS = {
    110: (0.359681315, 2.690526434, 11.776555930, -4.922126708, 25.025609332),
    150: (5.341391164, 10.775988731, 1.308623216, -16.566981017, 27.311311720),
    170: (7.934539862, 1.440182662, -23.315352254, -2.124820398, 22.831413847),
}


@pytest.mark.parametrize("degrees", ROLLER_NUMBERS)
def test_a_roller_on_the_shape_of_a_flat_followers_cam(degrees, roller_lift, record):
    lift = roller_lift(math.radians(degrees))
    contact = touch_translating(lift, ROLLER)
    pressure = math.degrees(math.atan2(contact.normal_x, contact.normal_y))
    found = (*(1e3 * value for value in lift), pressure, 1e3 * contact.cam_rate)
    names = ("lift (mm)", "slope (mm/rad)", "curvature (mm/rad²)", "pressure angle (deg)", "u/ω (mm)")
    # Interpolation between points at half a degree: 1e-7 of the curvature.
    for name, value, expected in zip(names, found, ROLLER_NUMBERS[degrees], strict=True):
        record("Cam", f"roller at {degrees}°: {name}", value, expected, EVALUATION, tolerance=2e-7)


# Lift of the valve (mm), its slope (mm/rad), cam load / valve force, u/omega and sliding/omega (mm).
FINGER_NUMBERS = {
    110: (0.56019848, 4.26446739, 1.43779759, 15.91609830, 23.91876106),
    150: (8.15550923, 14.73163077, 1.44433703, 6.67893051, 34.39295651),
    225: (4.22175975, -12.71668938, 1.44720037, 20.08061410, 18.13427724),
}


@pytest.mark.parametrize("degrees", FINGER_NUMBERS)
def test_a_finger_on_the_shape_of_a_flat_followers_cam(degrees, finger_lift, record):
    lift = finger_lift(math.radians(degrees))
    contact = touch_finger(lift, FINGER)
    mean, sliding = 0.5 * (contact.cam_rate + contact.follower_rate), contact.cam_rate - contact.follower_rate
    found = (1e3 * lift.s, 1e3 * lift.ds, lift.ds / contact.arm, 1e3 * mean, 1e3 * sliding)
    names = ("valve lift (mm)", "slope (mm/rad)", "load ratio", "u/ω (mm)", "sliding/ω (mm)")
    for name, value, expected in zip(names, found, FINGER_NUMBERS[degrees], strict=True):
        record("Cam", f"finger at {degrees}°: {name}", value, expected, EVALUATION, tolerance=3e-7)


def test_largest_lift_and_reversals_of_the_finger(finger_lift, record):
    largest = 1e3 * finger_lift(math.pi).s
    record("Cam", "finger: largest valve lift (mm)", largest, 11.42308106, EVALUATION, tolerance=1e-8)

    def entrainment(degrees):
        contact = touch_finger(finger_lift(math.radians(degrees)), FINGER)
        return contact.cam_rate + contact.follower_rate

    for low, high, expected in ((155.0, 158.0, 156.706084), (164.0, 167.0, 165.884849)):
        found = brentq(entrainment, low, high)
        record("Cam", "finger: reversal of entrainment (deg)", found, expected, EVALUATION, tolerance=1e-5)


@settings(max_examples=25, deadline=None)
@given(st.floats(-0.5, 0.5))
def test_a_tilted_face_gets_its_lift_back_and_does_no_other_work(tilt):
    """Round trip over the shape. The load's arm is the slope times n_y; sliding is that of cam on face;
    and the same cam lifts a face across its path by cos(tilt) times as much."""
    tilted = Flat(R0, tilt)
    shape = trace_shape(ANGLES, flat_lift, FOLLOWERS["flat"], tilted)
    assert shape.radius.min() > 0.0
    found = FOLLOWERS["flat"].follow(shape, tilted)
    exact = np.array([flat_lift(a) for a in found.angle])
    for value, wished in zip((found.lift, found.slope, found.curvature), exact.T, strict=True):
        np.testing.assert_allclose(value, wished, atol=1e-12)
    across = FOLLOWERS["flat"].follow(shape, FLAT)
    assert across.lift.max() == pytest.approx(math.cos(tilt) * found.lift.max(), rel=1e-12)
    h = 1e-5
    for degrees in (100.0, 140.0, 180.0, 230.0):
        a = math.radians(degrees)
        contact, cam = FOLLOWERS["flat"].touch(flat_lift(a), tilted), flat_lift(a)
        assert contact.arm == pytest.approx(cam.ds * contact.normal_y, abs=1e-15)
        assert contact.arm == pytest.approx(contact.x * contact.normal_y - contact.y * contact.normal_x)
        # Of the points' velocities: the cam's, less the face's s', along t = (-n_y, n_x).
        sliding = contact.x * contact.normal_x + contact.y * contact.normal_y - cam.ds * contact.normal_x
        assert contact.cam_rate - contact.follower_rate == pytest.approx(sliding, abs=1e-15)
        places = []
        for turn in (-h, h):
            lift = flat_lift(a + turn)
            there = FOLLOWERS["flat"].touch(lift, tilted)
            places.append(there.x * there.normal_y - (there.y - lift.s) * there.normal_x)
        rate = (places[1] - places[0]) / (2.0 * h)
        assert contact.follower_rate == pytest.approx(rate, abs=1e-8)


@settings(max_examples=25, deadline=None)
@given(
    st.sampled_from(["roller", "finger_pad"]),
    st.floats(4e-3, 30e-3),
    st.floats(-5e-3, 5e-3),
    st.floats(25e-3, 60e-3),
    st.floats(0.0, 0.4),
    st.sampled_from([1.0, -1.0]),
)
def test_the_cam_for_a_followers_lift_gives_that_lift_back(kind, radius, offset, arm, angle, side):
    """Round trip over the shape; virtual work: the load's arm is the slope of what it moves."""
    if kind == "roller":
        geometry = Translating(R0, radius, offset)
    else:
        geometry = Finger(R0, radius, side * arm, side * angle, side * 1.4 * arm, 0.0)
    lift = on_the_flat_cam(kind, geometry)
    shape = trace_shape(ANGLES, lift, FOLLOWERS[kind], geometry)
    flat = FOLLOWERS["flat"].follow(shape, FLAT)
    exact = np.array([flat_lift(a) for a in flat.angle])
    # The points are exact; the shape's angles are between them, interpolated to 1e-10 m.
    np.testing.assert_allclose(flat.lift, exact[:, 0], atol=1e-9)
    np.testing.assert_allclose(flat.slope, exact[:, 1], atol=1e-7)
    for degrees in (100.0, 140.0, 230.0):
        a, h = math.radians(degrees), 1e-5
        contact = FOLLOWERS[kind].touch(lift(a), geometry)
        if kind == "roller":
            virtual = lift(a).ds * contact.normal_y
        else:
            rate = turn_finger(lift(a), geometry).ds
            motion = move_finger(lift(a), geometry)
            virtual = contact.normal_x * motion.dx + contact.normal_y * motion.dy
            assert abs(rate * geometry.cam_arm) >= abs(virtual) - 1e-12
        assert contact.arm == pytest.approx(virtual, abs=1e-12)
        turned = [
            math.atan2(c.normal_x, c.normal_y)
            for c in (FOLLOWERS[kind].touch(lift(a + d), geometry) for d in (-h, h))
        ]
        # A central difference over 1e-5 rad of an interpolated curvature.
        assert (turned[1] - turned[0]) / (2.0 * h) == pytest.approx(contact.normal_turn, abs=2e-3)


def test_the_cam_for_a_wished_valve_lift_gives_it_back(record):
    """Finger: exact at the points of a contour from the law, interpolated between points at one degree."""
    shape = trace_shape(np.radians(np.arange(360.0)), flat_lift, FOLLOWERS["finger_pad"], FINGER)
    points = FOLLOWERS["finger_pad"].follow(shape, FINGER)
    lift, bound = through(points), "bound of an independent evaluation"
    for name, angles, found, tolerance in (
        ("from the law (m)", points.angle, points.lift, 1e-12),
        ("from a contour at 1° (m)", ANGLES, [lift(a).s for a in ANGLES], 1.7e-9),
    ):
        error = np.abs(found - np.array([flat_lift(a).s for a in angles])).max()
        record("Cam", f"round trip of a finger's lift {name}", error, 0.0, bound, tolerance=tolerance)


def test_what_cannot_be_assembled_is_refused_with_its_angle():
    """A hollow flank takes rollers that are smaller than it, and no flat follower."""
    geometry = Translating(12e-3, 5e-3, 0.0)
    hollow = trace_shape(ANGLES, flat_lift, FOLLOWERS["roller"], geometry)
    tightest = -hollow.radius[hollow.radius < 0.0].max()
    FOLLOWERS["roller"].follow(hollow, geometry._replace(radius=0.9 * tightest))
    with pytest.raises(ValueError, match=r"cannot touch the cam at .* deg"):
        FOLLOWERS["roller"].follow(hollow, geometry._replace(radius=1.1 * tightest))
    with pytest.raises(ValueError, match="cannot touch the cam"):
        FOLLOWERS["flat"].follow(hollow, Flat(12e-3))
