"""Parts of figures: windows, ticks, cuts at impacts."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from orchestrator.analyses._motion import draw_phase
from orchestrator.analyses.poincare import draw_poincare, magnify
from orchestrator.plots.motion import format_angle, shift_to_first_turn
from orchestrator.plots.style import create_subplots


@pytest.mark.parametrize(
    ("halves", "text"), [(0, "0"), (1, "π/2"), (2, "π"), (3, "3π/2"), (4, "2π"), (-1, "−π/2"), (-2, "−π")]
)
def test_angles_are_written_in_pi(halves: int, text: str) -> None:
    assert format_angle(0.5 * math.pi * halves) == text


@given(turns=st.integers(0, 10**6), phase=st.floats(0.0, 6.2))
@settings(derandomize=True, deadline=None)
def test_angles_count_from_their_own_revolution(turns: int, phase: float) -> None:
    """To the resolution of so large an angle."""
    theta = np.array([2.0 * math.pi * turns, 2.0 * math.pi * turns + phase])
    assert shift_to_first_turn(theta) == pytest.approx([0.0, phase], abs=1e-9)


@given(
    points=st.lists(st.tuples(st.floats(0.0, 6.28), st.floats(-1.0, 1.0)), min_size=1, max_size=30),
    centre=st.tuples(st.floats(0.0, 6.28), st.floats(-1.0, 1.0)),
    by=st.floats(1.0, 100.0),
)
@settings(derandomize=True, deadline=None)
def test_window_is_around_a_point_and_so_much_smaller(points: list, centre: tuple, by: float) -> None:
    """Its middle is one of the points, its width 2 pi over the magnification."""
    theta, rate = (np.array(column) for column in zip(*points, strict=True))
    low, high, bottom, top = magnify(theta, rate, centre, by)
    assert high - low == pytest.approx(2.0 * math.pi / by)
    middle = (0.5 * (low + high), 0.5 * (bottom + top))
    assert min(np.hypot(theta - middle[0], rate - middle[1])) < 1e-12


def test_window_shows_the_points_in_it() -> None:
    _, axes = create_subplots()
    draw_poincare(axes, np.array([1.0, 2.0, 3.0]), np.array([0.1, 0.2, 0.3]), window=(1.5, 3.5, 0.0, 0.25))
    np.testing.assert_array_equal(axes.collections[0].get_offsets(), [[2.0, 0.2]])


def test_phase_portrait_is_cut_at_impacts() -> None:
    """No line leads from before an impact to after it but the jump's own."""
    theta = np.array([0.0, 1.0, 1.0, 2.0])
    psi, rate = np.array([0.0, 1e-2, 1e-2, 0.0]), np.array([1.0, 1.0, -0.9, -0.9])
    _, axes = create_subplots()
    draw_phase(axes, theta, psi, rate, np.zeros(4))
    (line,) = axes.lines
    np.testing.assert_array_equal(line.get_ydata(), [1.0, 1.0, np.nan, -0.9, -0.9])
    (jump,) = axes.collections[0].get_segments()
    np.testing.assert_array_equal(jump, [[10.0, 1.0], [10.0, -0.9]])
