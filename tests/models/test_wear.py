"""Wear by Archard's law: rates of contacts, and a cam that wears."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from models.contact.wear import hertz_share, trapezoidal, worn_depth
from models.core.embedded_pair import march
from models.valve_train.cams.lift import Lift
from models.valve_train.cams.table import Points
from models.valve_train.followers.mechanisms import Flat, Translating
from models.valve_train.followers.shape import FOLLOWERS
from models.valve_train.worn_cam import (
    BEND,
    FINEST,
    PLACES,
    SPACING,
    CamKind,
    FreshCam,
    choose_filter,
    find_most_depth,
    find_overlap_by_lift,
    smooth,
)


def test_the_share_of_a_hertzian_load_is_its_integral():
    x = np.linspace(-1.0, 1.0, 200001)
    pressure = 2.0 / math.pi * np.sqrt(1.0 - x * x)
    integral = np.concatenate([[0.0], np.cumsum(0.5 * (pressure[1:] + pressure[:-1]) * np.diff(x))])
    # Trapezoidal rule at the square root's ends: about h^1.5 with h = 1e-5.
    np.testing.assert_allclose(hertz_share(x), integral, rtol=0.0, atol=1e-7)
    assert hertz_share(np.array([-9.0, 0.0, 9.0])) == pytest.approx([0.0, 0.5, 1.0], abs=1e-15)


@given(
    st.lists(
        st.tuples(st.floats(-1.0, 1.0), st.floats(1e-4, 0.3), st.floats(0.0, 5.0)), min_size=1, max_size=20
    )
)
def test_what_is_worn_off_is_the_dose(records):
    place, width, dose = (np.array(column) for column in zip(*records, strict=True))
    edges = np.linspace(-1.5, 1.5, 98)
    depth = worn_depth(edges, place, width, dose)
    assert depth @ np.diff(edges) == pytest.approx(dose.sum(), rel=1e-12, abs=1e-300)
    assert depth.min() >= 0.0
    # Of places that recur nothing is lost over the end.
    around = worn_depth(np.linspace(-1.0, 1.0, 98), place, width, dose, period=2.0)
    assert around.sum() * 2.0 / 97.0 == pytest.approx(dose.sum(), rel=1e-12, abs=1e-300)


def test_a_steady_pass_wears_load_over_length_times_the_ratio_of_speeds():
    """h = k (W/L) |u_s/v|, wherever the whole width has passed."""
    line_load, sliding, speed, width = 4e4, 3.0, 0.7, 1e-4
    time = np.linspace(0.0, 0.1, 20001)
    dose = line_load * sliding * trapezoidal(time)
    assert dose.sum() == pytest.approx(line_load * sliding * 0.1, rel=1e-12)
    depth = worn_depth(np.linspace(0.02, 0.05, 301), speed * time, np.full_like(time, width), dose)
    # Records lie 3.5e-6 apart, 1/29 of the half width: bins of 1e-4 see the ends of some of them.
    assert depth == pytest.approx(line_load * sliding / speed, rel=2e-3)


def test_a_standing_contact_wears_hertzs_profile():
    edges = np.linspace(-1e-4, 1e-4, 2001)
    depth = worn_depth(edges, np.zeros(1), np.array([1e-4]), np.array([5.0]))
    middle = 0.5 * (edges[1:] + edges[:-1])
    expected = 2.0 * 5.0 / (math.pi * 1e-4) * np.sqrt(1.0 - (middle / 1e-4) ** 2)
    # Means of bins of 1e-3 of the width against the middle; beside the ends the profile is steep.
    inside = np.abs(middle) < 0.9e-4
    assert depth[inside] == pytest.approx(expected[inside], rel=1e-5)


RADIUS, ECCENTRICITY = 25e-3, 5e-3
BASE = RADIUS - ECCENTRICITY


def eccentric() -> FreshCam:
    """A circle out of its centre: R0 + s = R - e cos psi."""
    lift = ECCENTRICITY * (1.0 - np.cos(PLACES))
    slope, curvature = ECCENTRICITY * np.sin(PLACES), ECCENTRICITY * np.cos(PLACES)
    one = np.ones_like(PLACES)
    return FreshCam(BASE, Points(PLACES, lift, slope, curvature), one, RADIUS * one)


def test_an_eccentric_circle_shrinks_about_the_axis_of_the_cam():
    """Under a constant load p = R0 + s loses w p/(p + p'') per dose, w = W/L. With p = a (R - e cos psi) that
    is a' = -w/R: the circle keeps its shape, its depth is w X (R - e cos psi)/R."""
    fresh, line_load = eccentric(), 5e4

    def rate(loss):
        p = fresh.wear_off(loss)
        rho = BASE + p.lift + p.curvature
        return line_load * smooth(BASE + p.lift, FINEST) / smooth(rho, FINEST)

    dose = 0.5e-3 / line_load
    steps = march(
        rate,
        np.zeros_like(PLACES),
        rate(np.zeros_like(PLACES)),
        0.1 * dose,
        1e-3,
        lambda loss, now: (0.0, dose),
    )
    for step in steps:
        if step.begin + step.length >= dose:
            break
    depth = step.at((dose - step.begin) / step.length)
    closed = line_load * dose * (RADIUS - ECCENTRICITY * np.cos(PLACES)) / RADIUS
    # Of a wave once around the filter takes 1 - exp(-width^2/2) = 6.1e-4, times e/R.
    np.testing.assert_allclose(depth, closed, rtol=2e-4)


def test_what_is_worn_off_goes_through_the_points_and_back():
    """Of a smooth loss the spline has lift, slope and curvature; none leaves the cam as it is."""
    fresh = eccentric()
    same = fresh.wear_off(np.zeros_like(PLACES))
    for name in ("lift", "slope", "curvature"):
        np.testing.assert_array_equal(getattr(same, name), getattr(fresh.points, name))
    worn = fresh.wear_off(1e-4 * (1.0 + np.cos(3.0 * PLACES)))
    np.testing.assert_allclose(fresh.points.lift - worn.lift, 1e-4 * (1.0 + np.cos(3.0 * PLACES)), atol=1e-17)
    np.testing.assert_allclose(fresh.points.slope - worn.slope, -3e-4 * np.sin(3.0 * PLACES), atol=1e-12)
    np.testing.assert_allclose(
        fresh.points.curvature - worn.curvature, -9e-4 * np.cos(3.0 * PLACES), atol=1e-10
    )


def test_a_depth_along_the_normal_lowers_a_follower_by_more_where_it_is_oblique():
    """A tilted flat follower by 1/cos(tilt), a roller by 1/cos of the pressure angle."""
    lift = Lift(3e-3, 8e-3, 0.0)
    flat = CamKind(None, None, FOLLOWERS["flat"], Flat(20e-3, 0.1))  # type: ignore[arg-type]
    roller = CamKind(None, None, FOLLOWERS["roller"], Translating(20e-3, 10e-3, 0.0))  # type: ignore[arg-type]

    class Fixed(CamKind):
        def lift(self, angle: float) -> Lift:
            return lift

    for cam, expected in ((flat, math.cos(0.1)), (roller, None)):
        fixed = Fixed(*cam)
        contact = cam.follower.touch(lift, cam.geometry)
        wanted = contact.normal_y if expected is None else expected
        # A difference over 1e-7 m of positions of 0.03 m.
        assert find_overlap_by_lift(fixed, 1.0) == pytest.approx(wanted, rel=1e-7)


def test_the_filter_keeps_volume_and_convexity():
    """A peak as deep as the limit bends the lift by half of the least arc, beside it."""
    narrow = np.zeros_like(PLACES)
    narrow[360] = 1.0
    for width in (FINEST, 0.15):
        assert smooth(narrow, width).sum() == pytest.approx(1.0, rel=1e-14)
    arc = np.full_like(PLACES, 20e-3)
    arc[200] = 5e-3
    depth = 0.1e-3
    width = choose_filter(depth, arc)
    peak = smooth(narrow, width)
    bend = depth / peak.max() * np.gradient(np.gradient(peak, SPACING), SPACING)
    # Differences over a place, which has a 17th of the width.
    assert bend.max() == pytest.approx(0.5 * arc.min(), rel=0.02)
    assert width == pytest.approx(math.sqrt(BEND * depth / 5e-3))
    assert choose_filter(find_most_depth(arc), arc) == pytest.approx(math.radians(15.0))
