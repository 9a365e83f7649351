"""Cam profiles: closed forms of the laws, ramps, tables as exact polynomials, smoothing of rounded lifts."""

import functools
import itertools
import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.polynomial import Polynomial

from models.core.component import Component
from models.valve_train.cams.law import law_lift
from models.valve_train.cams.profile import time_to_turn
from models.valve_train.cams.rises import RISES
from models.valve_train.cams.smoothing import smooth_lift
from models.valve_train.cams.table import Points, find_table_breaks, table_lift
from models.valve_train.camshaft import camshaft

S, B = 8e-3, math.radians(90.0)
LAWS = list(RISES)
BY_LAW = camshaft()
FOOT = math.pi - B
EVALUATION = "independent evaluation"


def law(name, **parameters):
    given = {"lift": S, "rise_angle": B, "dwell_half_width": 0.0, "law": LAWS.index(name)} | parameters
    return record_of(BY_LAW, given)


def record_of(component: Component, parameters):
    return component.parameters.view(component.parameters.vector(parameters))


def through(points: Points):
    return record_of(camshaft(table_points=points.angle.size), points.parameters())


def sample(lift, angles, p):
    return np.array([lift(a, p) for a in angles]).T


def test_high_powers_have_the_coefficients_of_their_closed_form(record):
    """The product formula against the equations that it solves: s and four derivatives vanish at the foot."""
    powers = np.array([2.0, 8.0, 14.0, 20.0, 26.0])
    # s(1) = -1 without its constant, and four derivatives 0.
    rows = [np.prod([powers - i for i in range(k)], axis=0) for k in range(1, 5)]
    coefficients = np.linalg.solve(np.array([np.ones(5), *rows]), [-1.0, 0.0, 0.0, 0.0, 0.0])
    x = np.linspace(0.0, 1.0, 50)
    exact = S * (1.0 + sum(c * x**n for c, n in zip(coefficients, powers, strict=True)))
    found = sample(law_lift, math.pi - B * x, law("high_powers"))[0]
    np.testing.assert_allclose(found, exact, atol=1e-13 * S)
    fine = np.linspace(math.pi - B, math.pi + B, 20001)
    # The trapezoidal rule, exact to its order 8 at ends where s to s'''' vanish.
    mean = np.trapezoid(sample(law_lift, fine, law("high_powers"))[0], fine) / (2.0 * B * S)
    record("Cam", "ample factor of the law high_powers", mean, 3328 / 6561, "closed form", tolerance=1e-12)


def test_the_modified_trapezoid_has_the_coefficients_of_its_closed_form(record):
    """Peak velocity 2 S/B, peak acceleration 8 pi/(pi + 2) S/B^2; x = 1/8 to 3/8 is the flank."""
    p, x = law("modified_trapezoid"), np.linspace(0.0, 1.0, 801)
    _, ds, dds = sample(law_lift, FOOT + B * x, p)
    exact, source = 8.0 * math.pi / (math.pi + 2.0), "closed form"
    name = "modified trapezoid: peak"
    record("Cam", f"{name} velocity (S/B)", ds.max() * B / S, 2.0, source, tolerance=1e-12)
    record("Cam", f"{name} acceleration (S/B²)", dds.max() * B**2 / S, exact, source, tolerance=1e-12)
    np.testing.assert_allclose(dds[101:300], dds.max(), rtol=1e-12)


@pytest.mark.parametrize(
    ("name", "shares"), [("cycloidal", (0.25, 0.0, 0.5, 0.0)), ("modified_sine", (0.125, 0.0, 0.75, 0.0))]
)
def test_the_modified_trapezoid_has_other_laws_as_its_limits(name, shares):
    """Sine, constant and cosine acceleration: the same closed forms."""
    angles = np.radians(np.arange(0.0, 360.0, 0.7))
    found = sample(law_lift, angles, law("modified_trapezoid", **dict(zip(SHARES, shares, strict=True))))
    np.testing.assert_allclose(found, sample(law_lift, angles, law(name)), atol=1e-13 * S * 100.0)


def test_shares_that_fill_the_rise_up_to_rounding_leave_no_fade():
    """0.08 + 0.1 + 0.12 + 0.7 is 1 less 1.1e-16: s'' is at the nose what it is beside it."""
    p = law("modified_trapezoid", **dict(zip(SHARES, (0.08, 0.1, 0.12, 0.7), strict=True)))
    assert law_lift(math.pi, p).dds == pytest.approx(law_lift(math.pi - 1e-3, p).dds, rel=1e-12)


SHARES = ("onset_share", "flank_share", "reversal_share", "nose_share")


@settings(max_examples=30, deadline=None)
@given(
    st.floats(0.02, 0.25), st.floats(0.0, 0.25), st.floats(0.02, 0.25), st.floats(0.0, 0.25), st.booleans()
)
def test_segments_of_acceleration_close_and_are_smooth(onset, flank, reversal, nose, fades):
    """Quadrature of s'' gives s' and s: velocity 0 and lift S at the nose; s'' is continuous at the borders,
    constant on flank and nose. Without fade the deceleration lasts to the nose."""
    nose = nose if fades else 1.0 - onset - flank - reversal
    p = law("modified_trapezoid", **dict(zip(SHARES, (onset, flank, reversal, nose), strict=True)))
    borders = np.minimum(np.cumsum([0.0, onset, flank, reversal, nose, 1.0]), 1.0)
    velocity = lift = 0.0
    for begin, end in itertools.pairwise(FOOT + B * borders):
        points, weights = np.polynomial.legendre.leggauss(12)
        angles, half = 0.5 * (begin + end + (end - begin) * points), 0.5 * (end - begin)
        bends = sample(law_lift, angles, p)[2] if half > 0.0 else np.zeros(12)
        lift += 2.0 * half * velocity + half * np.sum(weights * (end - angles) * bends)
        velocity += half * np.sum(weights * bends)
        found = law_lift(end - 1e-12, p)
        np.testing.assert_allclose((found.s, found.ds), (lift, velocity), atol=1e-10 * S)
    np.testing.assert_allclose((lift, velocity), (S, 0.0), atol=1e-10 * S)
    inner = FOOT + B * borders[1:4]
    before, after = (sample(law_lift, inner + d, p)[2] for d in (-1e-10, 1e-10))
    np.testing.assert_allclose(before, after, atol=1e-5 * S)
    assert (abs(law_lift(math.pi - 1e-9, p).dds) < 1e-3 * S) == fades


POLYNOMIALS = {
    "polynomial_345": Polynomial([0, 0, 0, 10, -15, 6]),
    "polynomial_4567": Polynomial([0, 0, 0, 0, 35, -84, 70, -20]),
}


@pytest.mark.parametrize("name", POLYNOMIALS)
def test_polynomials(name):
    x = np.linspace(0.0, 1.0, 101)[1:-1]
    found = sample(law_lift, FOOT + B * x, law(name))
    for n, column in enumerate(found):
        exact = S * (POLYNOMIALS[name].deriv(n)(x) if n else POLYNOMIALS[name](x)) / B**n
        np.testing.assert_allclose(column, exact, atol=1e-12 * S)


@pytest.mark.parametrize("name", LAWS)
def test_derivatives_are_those_of_the_lift(name):
    """Also of the ramps; central differences of order 2, away from the ends of the parts."""
    p, h = law(name, ramp_height=3e-4, fall_angle=math.radians(70.0)), 1e-5
    angles = np.radians([66.0, 75.0, 92.0, 97.0, 110.0, 130.0, 150.0, 175.0, 190.0, 230.0, 260.0, 263.0])
    before, here, after = (sample(law_lift, angles + d, p) for d in (-h, 0.0, h))
    # (h^2/6) s''' and s'''', at most 10 and 100 S; rounding of s is 1e-18/h.
    np.testing.assert_allclose((after[0] - before[0]) / (2.0 * h), here[1], atol=10.0 * S * h**2 + 1e-12)
    np.testing.assert_allclose((after[1] - before[1]) / (2.0 * h), here[2], atol=2e3 * S * h**2 + 1e-11)


@pytest.mark.parametrize("name", LAWS)
def test_laws_rise_from_zero_to_the_lift_with_continuous_curvature(name):
    p, e = law(name), 1e-9
    ends = sample(law_lift, [FOOT - e, FOOT + e, math.pi - e, math.pi + e], p)
    np.testing.assert_allclose(ends[0], [0.0, 0.0, S, S], atol=1e-12)
    np.testing.assert_allclose(ends[1], 0.0, atol=1e-9)
    jump = abs(ends[2, 1] - ends[2, 0])
    assert jump == pytest.approx(0.5 * S * (math.pi / B) ** 2) if name == "harmonic" else jump < 1e-8


@settings(max_examples=30, deadline=None)
@given(
    st.sampled_from(LAWS),
    st.floats(1e-5, 1e-3),
    st.floats(0.01, 0.6),
    st.floats(0.01, 0.6),
    st.floats(0.01, 0.2),
)
def test_ramps_add_their_height_and_a_constant_velocity(name, height, opening, closing, blend):
    ramped = law(
        name,
        ramp_height=height,
        opening_ramp_angle=opening,
        closing_ramp_angle=closing,
        ramp_blend_angle=blend,
    )
    plain = law(name)
    for side, constant in ((-1.0, opening), (1.0, closing)):
        at = [math.pi + side * (B + a) for a in (0.5 * constant, 0.0, -blend, constant + blend + 1e-6)]
        added = sample(law_lift, at, ramped) - sample(law_lift, at, plain)
        velocity = -side * height / (constant + blend)
        np.testing.assert_allclose(added[0, 2:], [height, 0.0], atol=1e-15)
        np.testing.assert_allclose(added[1], [velocity, velocity, 0.0, 0.0], atol=1e-12)


def test_ramp_of_the_reference_numbers(record):
    """0.3 mm from 65 degrees, 5 degrees of blending, 20 of constant velocity."""
    p = law("cycloidal", ramp_height=0.3e-3)
    taken_up = [a for a in np.linspace(1.2, 1.6, 4001) if law_lift(a, p).s < 0.1835e-3][-1]
    quantity = "ramp takes up 0.1835 mm at (deg)"
    record("Cam", quantity, math.degrees(taken_up), 82.794, EVALUATION, tolerance=0.01)
    velocity = law_lift(taken_up, p).ds * 1000.0 * math.pi / 30.0
    record("Cam", "velocity of the ramp, 1000 r/min (m/s)", velocity, 0.072, EVALUATION, tolerance=1e-5)


@settings(max_examples=8, deadline=None)
@given(st.floats(1e-5, 1e-3), st.floats(0.01, 0.6), st.floats(0.01, 0.6), st.floats(0.01, 0.2))
def test_a_table_has_the_ramps_of_a_law(height, opening, closing, blend):
    """They add the same, to rounding, and s'' stays continuous where they join the event."""
    ramps = {
        "ramp_height": height,
        "opening_ramp_angle": opening,
        "closing_ramp_angle": closing,
        "ramp_blend_angle": blend,
    }
    points = smoothed_law().points
    event = {"event_begin": FOOT, "event_end": math.pi + B}
    component = camshaft(table_points=points.angle.size)
    table, plain = (record_of(component, points.parameters() | event | more) for more in (ramps, {}))
    ramped, law_alone = law("polynomial_4567", **ramps), law("polynomial_4567")
    angles = np.linspace(-7.0, 12.0, 1999)
    added = sample(table_lift, angles, table) - sample(table_lift, angles, plain)
    wished = sample(law_lift, angles, ramped) - sample(law_lift, angles, law_alone)
    # s'' of a ramp is at most pi v/(2 blend): its rounding, by an angle of two turns.
    np.testing.assert_allclose(added, wished, atol=1e-14 / blend**3)
    breaks, at = [], 0.0
    while (at := at + find_table_breaks(at, table).ahead) < 2.0 * math.pi:
        breaks.append(at)
    feet = [
        math.pi + side * (B + turn)
        for side, c in ((-1, opening), (1, closing))
        for turn in (-blend, c, c + blend)
    ]
    np.testing.assert_allclose(breaks, sorted(feet), atol=1e-12)
    before, after = (sample(table_lift, np.array(breaks) + d, table) for d in (-1e-9, 1e-9))
    largest = np.abs(wished[2]).max()
    np.testing.assert_allclose(before[2], after[2], atol=1e-7 * (largest / blend + S))


@functools.cache
def smoothed_law():
    angles = np.radians(np.arange(360.0))
    return smooth_lift(angles, np.round(sample(law_lift, angles, law("polynomial_4567"))[0] / 1e-7) * 1e-7)


@pytest.mark.parametrize("turned", [90, *(pytest.param(a, marks=pytest.mark.long) for a in (0, 180, 270))])
def test_the_event_of_a_table_does_not_depend_on_where_it_begins(turned):
    """A thousandth of the lift is reached at 35 x^4 = 1e-3, to the spacing of the samples."""
    table, angles = through(smoothed_law().points), np.radians(np.arange(360.0))
    lifts = np.roll([table_lift(a, table).s for a in angles], turned)
    begin, end = smooth_lift(angles, lifts).event
    inside = B * (1e-3 / 35.0) ** 0.25
    assert (begin - math.radians(turned)) % (2.0 * math.pi) == pytest.approx(FOOT + inside, abs=0.02)
    assert end - begin == pytest.approx(2.0 * (B - inside), abs=0.03)


def test_a_table_is_exact_for_polynomials_of_degree_five():
    p = law("polynomial_345")
    breaks = np.array([0.0, FOOT, math.pi, math.pi + B])
    s, ds, dds = sample(law_lift, breaks, p)
    table = through(Points(breaks, s, ds, dds, smooth=False))
    angles = np.linspace(-7.0, 12.0, 999)
    # Rounding of an angle of two turns.
    np.testing.assert_allclose(sample(table_lift, angles, table), sample(law_lift, angles, p), atol=1e-14)


def test_lift_tables_are_smoothed_to_the_accuracy_of_their_samples(record):
    """Rounded samples at 1 degree; the loads with the spring and mass of the set `kushwaha2000`."""
    p = law("high_powers")
    samples, fine = np.radians(np.arange(360.0)), np.radians(np.arange(0.0, 360.0, 0.1))
    exact = sample(law_lift, fine, p)
    for step, curvature, newton in ((1e-7, 0.12e-3, 1.0), (1e-6, 0.35e-3, 2.0)):
        rounded = np.round(sample(law_lift, samples, p)[0] / step) * step
        smoothed = smooth_lift(samples, rounded)
        found = sample(table_lift, fine, through(smoothed.points))
        error = np.abs(found[2] - exact[2]).max()
        loads = [35e3 * s + 0.22 * dds * (100.0 * math.pi) ** 2 for s, _, dds in (found, exact)]
        change = max(abs(loads[0].max() - loads[1].max()), abs(loads[0].min() - loads[1].min()))
        name = f"lift table of {1e3 * step:g} mm at 1°"
        record("Cam", f"{name}: error of s'' (m/rad²)", error, 0.0, "closed form", tolerance=curvature)
        quantity = f"{name}: error of load extremes, 3000 r/min (N)"
        record("Cam", quantity, change, 0.0, "closed form", tolerance=newton)
        # Its own estimates: the rounding step within a half, and three standard deviations.
        assert smoothed.resolution == pytest.approx(step, rel=0.5)
        assert error < 3.0 * smoothed.curvature_error


def test_a_table_whose_angles_do_not_ascend_is_refused():
    component = camshaft(table_points=3)
    values = {"table_angle[1]": 0.0, "table_angle[2]": 2.0, "table_angle[3]": 1.0}
    assert (
        "table_angle[2] = 114.592 deg" in component.parameter_faults(component.parameters.vector(values))[0]
    )
    round_cam = Points(np.array([0.0, 1.0, 2.0]), *np.zeros((3, 3))).parameters()
    wide = {"ramp_height": 1e-4, "event_begin": 0.5, "event_end": 6.0}
    (fault,) = component.parameter_faults(component.parameters.vector(round_cam | wide))
    assert "at most 180 deg" in fault
    with pytest.raises(ValueError, match="table_points = 2"):
        camshaft(table_points=2)


@pytest.mark.parametrize("speed", [-2.0, 0.0, 2.0])
@pytest.mark.parametrize("acceleration", [-3.0, 0.0, 3.0])
def test_an_angle_is_reached_when_the_motion_has_turned_so_far(speed: float, acceleration: float) -> None:
    assert time_to_turn(math.inf, speed, acceleration) == math.inf
    t = time_to_turn(0.1, speed, acceleration)
    if math.isfinite(t):
        assert t > 0.0
        assert speed * t + 0.5 * acceleration * t * t == pytest.approx(0.1, rel=1e-14)
    else:
        assert speed <= 0.0 >= acceleration
