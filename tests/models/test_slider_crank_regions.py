"""Where the walls can hold the slider (F 2.6): zeros of the constraint forces, regions, thresholds."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from models.core.quantities import Vector
from models.slider_crank.flight.series import TERMS
from models.slider_crank.motions.machine import FORMS, Machine
from models.slider_crank.motions.regions import (
    critical_damping,
    force_zeros,
    holding_intervals,
    region,
    series_zeros,
    sign_changes,
    thresholds,
    wall_forces,
)

UPPER, LOWER = 1.0, -1.0
TURN = 2.0 * math.pi
# A force of one unit is that of a body accelerated by l Omega^2; rounding of its sums.
ROUNDING = 1e-14
MACHINES = st.builds(
    Machine,
    damping=st.floats(0.0, 0.4),
    gap=st.floats(1e-4, 0.06),
    form=st.sampled_from(FORMS),
    xi=st.floats(0.05, 0.6),
)


@given(machine=MACHINES, side=st.sampled_from([UPPER, LOWER]))
@settings(derandomize=True, deadline=None, max_examples=60)
def test_force_is_zero_at_every_boundary_angle(machine: Machine, side: float) -> None:
    """... of the sign that the intervals say between them, and none is missed by a fine scan."""
    zeros = force_zeros(machine, side)
    assert np.all(np.abs(wall_forces(machine, side, zeros)) < ROUNDING)
    theta = np.linspace(0.001, TURN, 2000, endpoint=False)
    holds = np.zeros(theta.size, dtype=bool)
    for start, end in holding_intervals(machine, side):
        holds |= ((theta > start) & (theta < end)) | (theta + TURN < end)
    forces = wall_forces(machine, side, theta)
    clear = np.abs(forces) > 1e-9
    np.testing.assert_array_equal(holds[clear], forces[clear] > 0.0)
    assert sign_changes(machine, side) % 2 == 0


def series_of_cosine(cells: int, mean: float, at: float) -> Vector:
    """mean + cos(theta - at) as series of the cells."""
    width = TURN / cells
    starts = width * np.arange(cells) - at
    orders = np.arange(TERMS)
    factors = np.array([width**n / math.factorial(n) for n in orders])
    series: Vector = factors * np.cos(starts[:, np.newaxis] + 0.5 * math.pi * orders)
    series[:, 0] += mean
    return series


@pytest.mark.parametrize("apart", [1.0, 1e-3, 3e-6])
@pytest.mark.parametrize("at", [0.0, 1.0, math.pi, 5.0])
def test_close_zeros_are_both_found(apart: float, at: float) -> None:
    """cos(apart / 2) + cos(theta - at): two zeros, `apart` from each other, wherever cells begin. Rounding
    of the function moves them by 1e-16 / apart."""
    found = series_zeros(series_of_cosine(64, math.cos(0.5 * apart), at))
    exact = np.sort(np.mod([at + math.pi - 0.5 * apart, at + math.pi + 0.5 * apart], TURN))
    np.testing.assert_allclose(found, exact, atol=1e-14 + 1e-15 / apart)


def test_a_double_zero_is_found_once() -> None:
    """1 + cos theta at pi, where a cell begins and rounding leaves it exact; 1e-12 above it none."""
    np.testing.assert_allclose(series_zeros(series_of_cosine(64, 1.0, 0.0)), [math.pi], atol=1e-7)
    assert len(series_zeros(series_of_cosine(64, 1.0 + 1e-12, 0.0))) == 0


@pytest.mark.parametrize("form", FORMS)
@pytest.mark.parametrize(("side", "name"), [(UPPER, "upper"), (LOWER, "lower")])
def test_two_zeros_end_at_the_threshold(form: str, side: float, name: str) -> None:
    """1e-9 below it the force has two, 1e-9 above it none."""
    machine = Machine(gap=0.01, form=form)
    limit = getattr(thresholds(machine), name)
    below, above = (force_zeros(replace(machine, damping=limit * (1.0 + d)), side) for d in (-1e-9, 1e-9))
    assert (len(below), len(above)) == (2, 0)


@pytest.mark.plain
@pytest.mark.parametrize(
    ("form", "closed", "wide"),
    [("as_published", 0.2669, 0.2660), ("corrected", 0.1196, 0.1069), ("nonlinear", 0.1196, 0.1071)],
)
def test_the_upper_wall_holds_from_a_friction_on(form: str, closed: float, wide: float) -> None:
    """To four digits; without a gap from an independent evaluation."""
    found = [thresholds(Machine(gap=gap, form=form)).upper for gap in (0.0, 0.02)]
    assert found == pytest.approx([closed, wide], abs=5e-5)


@given(theta=st.floats(0.0, TURN), gap=st.floats(0.0, 0.05), form=st.sampled_from(FORMS))
@settings(derandomize=True, deadline=None)
def test_symmetries_of_the_wall_forces(theta: float, gap: float, form: str) -> None:
    """lambda = 0: theta -> -theta turns the mechanism over, so that f_u(-theta) = f_l(theta). gap = 0: both
    walls' forces are opposite. (F 2.6 says that half a turn reverses them: its own force has a part in
    sin 2 theta.)"""
    free, closed = Machine(damping=0.0, gap=gap, form=form), Machine(damping=10.0 * gap, gap=0.0, form=form)
    for machine, image, sign in ((free, -theta, 1.0), (closed, theta, -1.0)):
        upper = wall_forces(machine, UPPER, np.array([image]))
        lower = wall_forces(machine, LOWER, np.array([theta]))
        assert upper == pytest.approx(sign * lower, abs=ROUNDING)


@given(machine=MACHINES, side=st.sampled_from([UPPER, LOWER]), theta=st.floats(0.0, TURN))
@settings(derandomize=True, deadline=None)
def test_critical_damping_makes_the_force_zero(machine: Machine, side: float, theta: float) -> None:
    """Friction presses to the upper wall: there more of it holds, at the lower wall less."""
    at = np.array([theta])
    limit = float(critical_damping(machine, side, at)[0])
    below, zero, above = (
        wall_forces(replace(machine, damping=abs(limit) + step), side, at) for step in (0.0, 0.0, 0.1)
    )
    if limit >= 0.0:
        assert zero == pytest.approx(0.0, abs=ROUNDING)
    assert (above > below) if side == UPPER else (above < below)


@given(machine=MACHINES)
@settings(derandomize=True, deadline=None, max_examples=40)
def test_region_is_what_the_forces_say(machine: Machine) -> None:
    """By the intervals found from the forces' zeros, independent of the thresholds."""
    throughout = holding_intervals(machine, UPPER) == [(0.0, TURN)]
    lower = bool(holding_intervals(machine, LOWER))
    said = {(False, True): "I", (True, True): "II", (True, False): "III", (False, False): "none"}
    assert region(machine) == said[throughout, lower]


def test_there_is_a_region_that_f_does_not_have() -> None:
    """Wide clearance and a heavy rod: at the lower threshold the upper wall still lets go."""
    machine = Machine(gap=0.065, form="nonlinear", xi=0.53, alpha=3.9, beta=0.18)
    limits = thresholds(machine)
    assert limits.lower < limits.upper
    between = replace(machine, damping=0.5 * (limits.lower + limits.upper))
    assert region(between) == "none"
    assert holding_intervals(between, LOWER) == []
    assert holding_intervals(between, UPPER) != [(0.0, TURN)]


@pytest.mark.parametrize("form", FORMS)
def test_without_a_crank_only_friction_presses(form: str) -> None:
    """xi = 0: the upper wall holds throughout at any friction; without it there is no force, and no zero."""
    still = Machine(damping=0.0, xi=0.0, form=form)
    assert thresholds(still) == pytest.approx((0.0, 0.0), abs=ROUNDING)
    assert (len(force_zeros(still, UPPER)), sign_changes(still, UPPER)) == (0, 0)
    assert holding_intervals(replace(still, damping=0.1), UPPER) == [(0.0, TURN)]
    assert region(replace(still, damping=0.1)) == "III"
