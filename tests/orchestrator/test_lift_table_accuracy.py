"""Lift tables: how exact their acceleration is, and which rows are doubted."""

import math

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from scipy.interpolate import CubicSpline

from orchestrator.scenario.lift_table import LiftTable

from .test_lift_table import ANGLES, RISE, TOP, lift, list_doubts, lobe, read

# Largest acceleration of the lobe, m/rad^2.
STEEPEST = 7.51319 * TOP * 1e-3 / math.radians(RISE) ** 2


@pytest.mark.parametrize(("rounding", "noise"), [(1e-3, 0.0), (1e-6, 2e-3)])
@given(row=st.integers(40, 120), error=st.sampled_from([-0.1, -0.02, 0.02, 0.1]))
@settings(max_examples=10, deadline=None)
@pytest.mark.long
def test_one_wrong_row_is_named_and_none_without_it(rounding, noise, row, error):
    """The row's deviation from the spline through the others is its error."""
    random = np.random.default_rng(row)
    lifts = lift(ANGLES) + noise * random.standard_normal(ANGLES.size)
    lifts = np.round(lifts / rounding) * rounding
    assert LiftTable(np.radians(ANGLES), 1e-3 * lifts, 0.0).smooth().doubtful is None
    lifts[row] += error
    angle, deviation = LiftTable(np.radians(ANGLES), 1e-3 * lifts, 0.0).smooth().doubtful
    assert angle == np.radians(ANGLES[row])
    assert deviation == pytest.approx(
        1e-3 * error, abs=1e-3 * (0.02 * abs(error) + 2.0 * rounding + 5.0 * noise)
    )


@pytest.mark.long
@given(seed=st.integers(0, 1000), decimals=st.integers(3, 9))
@settings(max_examples=10, deadline=None)
def test_uneven_and_coarse_tables_without_errors_but_rounding_are_not_doubted(seed, decimals):
    angles = np.unique(np.round(np.random.default_rng(seed).uniform(100.0, 260.0, 120), 6))
    assume(np.diff(angles).max() < 10.0)  # deg: where the cam lifts, longer gaps are refused
    for degrees in (angles, np.arange(100.0, 261.0, 5.0)):
        lifts = np.round(lift(degrees), decimals)
        table = LiftTable(np.radians(degrees), 1e-3 * lifts, 10.0 ** (-3 - decimals))
        assert table.smooth().doubtful is None


@pytest.mark.parametrize("spacing", [1.0, 1.5, 2.0, 2.5])
@pytest.mark.parametrize("offset", [0.0, 0.37])
def test_coarse_and_rounded_tables_have_the_acceleration_of_their_cam(tmp_path, spacing, offset):
    """Lifts in steps of 0.01 mm: 5 % of the largest acceleration, or the stated error."""
    angles = np.arange(-90.0, 90.0, spacing) + offset
    smoothed = read(tmp_path, row="{0:g}, {1:.2f}", angles=angles, lifts=lobe(angles))
    points = smoothed.smooth()
    x = np.clip(1.0 - np.abs((np.degrees(points.points.angle) + 180.0) % 360.0 - 180.0) / RISE, 0.0, 1.0)
    exact = TOP * 1e-3 / math.radians(RISE) ** 2 * (420 * x**2 - 1680 * x**3 + 2100 * x**4 - 840 * x**5)
    error = np.abs(points.points.curvature - exact).max()
    # Cross-validation smooths too little for one offset of ten; then the stated error is above 5 %.
    assert error < max(0.05 * STEEPEST, points.curvature_error)
    assert error < 0.05 * STEEPEST or points.curvature_error > 0.05 * np.abs(points.points.curvature).max()
    assert points.doubtful is None


# Laws over 0 to 1, and their second derivatives.
LAWS = {
    "345": (lambda x: x**3 * (10 - 15 * x + 6 * x**2), lambda x: 60 * x - 180 * x**2 + 120 * x**3),
    "4567": (
        lambda x: x**4 * (35 - 84 * x + 70 * x**2 - 20 * x**3),
        lambda x: 420 * x**2 - 1680 * x**3 + 2100 * x**4 - 840 * x**5,
    ),
    "cycloid": (
        lambda x: x - np.sin(2 * np.pi * x) / (2 * np.pi),
        lambda x: 2 * np.pi * np.sin(2 * np.pi * x),
    ),
}


def judge(name, top, sides, first, spacing, step):
    """The error of s'' at the rows of a turn and midway, that of its peak, and the stated one; as parts of
    the largest s''."""

    def evaluate(degrees, function, power):
        turned = (degrees + 180.0) % 360.0 - 180.0
        side = np.where(turned < 0.0, *sides)
        return top * function(np.clip(1.0 - np.abs(turned) / side, 0.0, 1.0)) / np.radians(side) ** power

    degrees = np.arange(first, 360.0, spacing)
    lifts = np.round(evaluate(degrees, LAWS[name][0], 0) / step) * step
    found = LiftTable(np.radians(degrees), 1e-3 * lifts, 1e-3 * step).smooth()
    own = np.append(
        found.points.curvature, CubicSpline(degrees, found.points.curvature)(degrees[:-1] + 0.5 * spacing)
    )
    true = 1e-3 * evaluate(np.append(degrees, degrees[:-1] + 0.5 * spacing), LAWS[name][1], 2)
    largest = 1e-3 * evaluate(np.linspace(-90.0, 90.0, 9001), LAWS[name][1], 2).max()
    peak = found.points.curvature.max()
    return np.abs(own - true).max() / largest, abs(peak / largest - 1.0), found.curvature_error / largest


@pytest.mark.parametrize(
    "table",
    [
        ("cycloid", 6.7608, (45.3363, 62.6125), 0.0, 1.5, 1e-3),
        ("cycloid", 8.0287, (50.32, 60.1308), 0.0, 2.0, 1e-3),
        ("4567", 8.2542, (66.2032, 55.249), 0.0, 2.5, 0.0254),
        ("345", 6.0647, (51.5918, 58.7345), 0.37, 3.0, 0.0254),
    ],
)
def test_an_acceleration_that_is_off_by_more_than_five_percent_is_doubted(table):
    error, peak, said = judge(*table)
    assert 0.05 < error < 1.1 * said
    assert peak < said > 0.05


@pytest.mark.long
def test_the_stated_error_of_the_acceleration_holds_for_most_tables():
    """Of 221 others at random 9 exceeded it, by up to 39 %; of those without a doubt none exceeded 5 %."""
    random = np.random.default_rng(1)
    ratios = []
    for _ in range(40):
        sides = tuple(random.uniform(45.0, 75.0, 2))
        spacing = random.choice([1.5, 2.0, 2.5, 3.0, 4.0, 5.0])
        step = random.choice([1e-5, 1e-3, 1e-2, 0.0127, 0.0254])
        error, _, said = judge(
            random.choice(list(LAWS)),
            random.uniform(6.0, 12.0),
            sides,
            random.uniform(0.0, spacing),
            spacing,
            step,
        )
        assert error < 0.055 or said > 0.05
        ratios.append(error / max(said, 0.05))
    assert np.mean(np.array(ratios) > 1.0) < 0.1
    assert max(ratios) < 1.5


@pytest.mark.parametrize("spacing", [1.0, 2.0])
@pytest.mark.parametrize("error", [-0.15, 0.15])
@pytest.mark.parametrize("degrees", [-58.0, -30.0, 0.0, 44.0])
def test_a_typing_error_is_named_by_its_row(tmp_path, spacing, error, degrees):
    angles = np.arange(-90.0, 91.0, spacing)
    lifts = lobe(angles) + error * (angles == degrees)
    said = list_doubts(tmp_path, row="{0:g}, {1:.2f}", angles=angles, lifts=lifts)
    assert f"the row at {degrees:g} deg is" in said
    assert "more rows" not in said  # its error is not one of the spacing
    assert "acceleration may be off by" in said
