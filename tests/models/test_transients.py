"""Escape from transient chaos: the fit of an exponential distribution, and its starts."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from models.slider_crank.motions.machine import Machine
from models.slider_crank.motions.transients import (
    Transients,
    draw_starts,
    fit_escape_time,
    measure_transients,
)


def drawn(mean: float, seed: int, count: int, cycles: int) -> Transients:
    """Lengths from an exponential distribution beyond 30, seen for so many cycles."""
    lengths = 30.0 + np.random.default_rng(seed).exponential(mean, count)
    settled = lengths < cycles
    return Transients(np.zeros((count, 2)), np.where(settled, lengths, cycles), settled.astype(int), cycles)


@given(mean=st.floats(50.0, 5000.0), seed=st.integers(0, 1000))
@settings(derandomize=True, deadline=None, max_examples=50)
def test_the_mean_escape_time_is_found_within_its_error_though_some_never_escape(
    mean: float, seed: int
) -> None:
    found = fit_escape_time(drawn(mean, seed, 4000, 5000))
    assert found is not None
    # 50 draws: 4.5 standard errors are passed with probability 3e-4.
    assert abs(found.mean - mean) < 4.5 * found.error
    # Kolmogorov and Smirnov: 2/sqrt(n) is passed with probability 7e-4 at most.
    assert found.distance < 2.0 / np.sqrt(4000)


def test_lengths_that_are_not_exponential_are_far_from_their_fit_and_none_has_no_fit() -> None:
    found = fit_escape_time(Transients(np.zeros((500, 2)), np.full(500, 130.0), np.ones(500), 1000))
    assert found is not None
    assert found.mean == 100.0
    assert found.distance > 0.3
    assert fit_escape_time(Transients(np.zeros((3, 2)), np.full(3, 100.0), np.zeros(3), 100)) is None


def test_starts_are_between_the_walls_and_repeat_with_their_seed() -> None:
    machine = Machine(gap=0.01)
    starts = draw_starts(machine, 1000, seed=3)
    assert np.all(np.abs(starts) <= [0.01, 0.1])
    assert np.abs(starts).max(axis=0) == pytest.approx([0.01, 0.1], rel=0.02)
    np.testing.assert_array_equal(starts, draw_starts(machine, 1000, seed=3))


@pytest.mark.long
def test_transient_chaos_of_the_thesis_does_not_depend_on_the_workers() -> None:
    machine = Machine(damping=0.075, gap=0.01, form="as_published")
    starts = draw_starts(machine, 40)
    one, two = (measure_transients(machine, starts, 4000, workers) for workers in (1, 2))
    np.testing.assert_array_equal(one.lengths, two.lengths)
    assert one.settled.all()
    assert one.lengths.max() > 100
