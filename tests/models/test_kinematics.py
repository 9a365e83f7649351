"""The cam of the set `kushwaha2000` against closed forms and an independent evaluation."""

import math
import re
from decimal import Decimal, getcontext

import pytest

from models.catalogue import CATALOGUE
from models.valve_train.cams.law import LAW, law_lift
from models.valve_train.cams.profile import entraining_velocity, find_smallest_radius, radius_of_curvature
from models.valve_train.camshaft import camshaft

from .systems import outputs_of

pytestmark = pytest.mark.plain

S, R0 = 8e-3, 2.610272395869072 * 8e-3
B, DWELL = math.radians(88.66608103115016), math.radians(1.333918968849847)
KUSHWAHA_CAM = camshaft().parameters.defaults()
SPEED = 1000.0 * math.pi / 30.0
KUSHWAHA, EVALUATION = "zeros stated by Kushwaha et al. (2000)", "independent evaluation"


def cam(degrees: float):
    return law_lift(math.radians(degrees), KUSHWAHA_CAM)


def decimal_sine(x: Decimal) -> Decimal:
    """The series, to 40 digits."""
    term, total, n = x, x, 1
    while abs(term) > Decimal(10) ** -45:
        term *= -x * x / ((n + 1) * (n + 2))
        total += term
        n += 2
    return total


@pytest.mark.parametrize("turns", [0, 3])
@pytest.mark.parametrize("degrees", [90.5, 120, 168, 178, 182, 216, 269])
def test_lift_and_its_derivatives_agree_with_forty_digits(degrees, turns, record):
    """Of the rise, and of the fall, which mirrors it; turns repeat."""
    getcontext().prec = 50
    pi = Decimal("3.14159265358979323846264338327950288419716939937510")
    rise, half = Decimal(B), Decimal(DWELL)
    a = rise - (abs(Decimal(math.radians(degrees)) - pi) - half)
    side = 1 if degrees < 180 else -1
    turned = 2 * pi * a / rise
    lift = Decimal(S) * (a / rise - decimal_sine(turned) / (2 * pi))
    slope = side * Decimal(S) / rise * (1 - decimal_sine(turned + pi / 2))
    bend = Decimal(S) / rise * (2 * pi / rise) * decimal_sine(turned)
    found = cam(degrees + 360.0 * turns)
    # 1e-10 of the profile's size; rounding of the angle alone is 4e-16.
    for name, value, exact in (("lift s", found.s, lift), ("s'", found.ds, slope), ("s''", found.dds, bend)):
        record("Cam", f"{name} / S", value / S, float(exact) / S, "closed form in 40 digits", tolerance=1e-10)


@pytest.mark.parametrize("from_nose", [-36, -12, 12, 36])
def test_entraining_velocity_vanishes_where_the_source_says(from_nose, record):
    velocity = entraining_velocity(R0, cam(180 + from_nose), SPEED) / (SPEED * R0)
    record("Cam", "entraining velocity / (ω R0) at its zeros", velocity, 0.0, KUSHWAHA, tolerance=1e-10)


@pytest.mark.parametrize(("degrees", "lift"), [(0, 0), (45, 0), (89.99, 0), (178.7, S), (180, S), (270.1, 0)])
def test_base_circle_and_nose_dwell(degrees, lift):
    assert tuple(cam(degrees)) == (lift, 0.0, 0.0)


def test_numbers_at_120_degrees_and_1000_rpm(record):
    at = cam(120)
    radius, velocity = radius_of_curvature(R0, at), entraining_velocity(R0, at, SPEED)
    # Half a unit of the last digit stated.
    for name, value, stated, tolerance in (
        ("lift", at.s, 1.625e-3, 0.5e-6),
        ("velocity of the follower", at.ds * SPEED, 0.8267, 0.5e-4),
        ("acceleration of the follower", at.dds * SPEED**2, 195.6, 0.05),
        ("radius of curvature", radius, 40.34e-3, 0.5e-5),
        ("entraining velocity", velocity, 3.046, 0.5e-3),
    ):
        record("Cam", f"{name} at 120°, 1000 r/min", value, stated, EVALUATION, tolerance=tolerance)


def test_smallest_radius_is_7_125_mm(record):
    smallest = find_smallest_radius(LAW)(KUSHWAHA_CAM)
    record("Cam", "smallest radius of curvature", smallest, 7.125e-3, EVALUATION, tolerance=0.5e-6)
    assert radius_of_curvature(R0, cam(180 + 24.4)) == pytest.approx(7.125e-3, abs=1e-6)


def test_camshaft_outputs_are_the_kinematics():
    """At 120 degrees, driven at twice the cam's speed: the drive gives half of the cam's torque."""
    y = outputs_of(
        CATALOGUE["camshaft"](),
        {"drive_ratio": 0.5, "phase": math.radians(30)},
        inputs={"drive_angle": math.radians(180), "drive_speed": 2 * SPEED, "contact_load": 500.0},
    )
    at = cam(120)
    expected = {
        "cam_angle": math.radians(120),
        "cam_speed": SPEED,
        "cam_lift": at.s,
        "surface_position": at.s,
        "surface_velocity": at.ds * SPEED,
        "sliding_velocity": SPEED * (R0 + at.s),
        "drive_torque": 0.5 * 500.0 * at.ds,
    }
    assert {name: y[name] for name in expected} == pytest.approx(expected, rel=1e-13)


def test_undercut_is_refused():
    camshaft = CATALOGUE["camshaft"]()
    faults = camshaft.parameter_faults(camshaft.parameters.vector({"base_radius": 10e-3}))
    assert len(faults) == 1
    assert "undercut" in faults[0]
    (needed,) = re.findall(r"take base_radius > ([\d.]+) mm", faults[0])
    for radius, count in ((float(needed), 0), (float(needed) - 0.002, 1)):
        assert (
            len(camshaft.parameter_faults(camshaft.parameters.vector({"base_radius": 1e-3 * radius})))
            == count
        )
