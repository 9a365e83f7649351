"""Recurrence and kinds of motion: periods of constructed sequences, escape from chaos, known motions."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from models.slider_crank.motions.classification import (
    CHAOTIC,
    PERIODIC,
    TRANSIENT_CHAOS,
    UNDECIDED,
    WINDOW,
    classify,
)
from models.slider_crank.motions.machine import Machine
from models.slider_crank.motions.recurrence import (
    REPEATS,
    SETTLED,
    TOLERANCE,
    find_recurrence,
    run_until_recurrent,
)
from models.slider_crank.motions.transients import Transients, draw_starts, fit_escape_time


def states(psi, side=0.0):
    """States at crank angle zero with psi and a psi' that depends on it."""
    psi = np.asarray(psi, dtype=float)
    return np.stack([psi, np.cos(psi), np.broadcast_to(side, psi.shape)], axis=1)


def orbit(period: int, seed: int):
    """Different values, one a cycle."""
    return 0.5 + np.random.default_rng(seed).permutation(period) / (2.0 * period)


@given(
    period=st.integers(1, 40),
    seed=st.integers(0, 2**32 - 1),
    before=st.integers(0, 50),
    extra=st.integers(0, 39),
)
@settings(derandomize=True, deadline=None, max_examples=100)
def test_the_smallest_period_is_found_exactly(period, seed, before, extra):
    values = orbit(period, seed)
    length = (REPEATS + 1) * period + extra
    start = np.random.default_rng(seed + 1).uniform(-1.0, -0.5, before)
    found = find_recurrence(states(np.concatenate([start, np.resize(values, length)])))
    assert found is not None
    assert (found.period, found.transient, found.exact, found.distance) == (period, before, True, 0.0)
    assert found.repeats == length // period


@given(period=st.integers(1, 12), seed=st.integers(0, 2**32 - 1), rate=st.floats(0.02, 3.0))
@settings(derandomize=True, deadline=None, max_examples=50)
def test_an_orbit_approached_exponentially_is_found_with_its_transient(period, seed, rate):
    cycles = np.arange(int(REPEATS * period + 30.0 / rate) + 1)
    psi = np.resize(orbit(period, seed), len(cycles))
    found = find_recurrence(states(psi + np.exp(-rate * cycles)))
    assert found is not None
    assert found.period == period
    # psi of size 1: settled at exp(-rate t) = SETTLED; the scale is between 1/2 and 2.
    assert abs(found.transient - np.log(1.0 / SETTLED) / rate) <= np.log(2.0) / rate + 1.0


@pytest.mark.parametrize(
    ("sequence", "period", "exact"),
    [
        pytest.param(states(0.7 + 10.0 * TOLERANCE * (np.arange(200) % 2)), 2, True, id="doubled"),
        pytest.param(states(np.full(100, 0.7), np.arange(100) % 2), 2, True, id="on and off the wall"),
        pytest.param(states(np.resize(orbit(97, 5), 200)), 97, True, id="long, to the last bit"),
        pytest.param(
            states(np.resize(orbit(4, 1), 60) * (1.0 + 1e-15 * (np.arange(60) // 4 % 3))),
            4, True, id="rounding that repeats later",
        ),
    ],
)  # fmt: skip
def test_what_is_and_is_not_the_same_state(sequence, period, exact):
    found = find_recurrence(sequence)
    assert found is not None
    assert (found.period, found.exact) == (period, exact)


@given(st.floats(0.05, 0.95))
@settings(derandomize=True, deadline=None, max_examples=30)
def test_a_logistic_map_in_chaos_does_not_repeat(start):
    psi = [start]
    for _ in range(3000):
        psi.append(3.9999 * psi[-1] * (1.0 - psi[-1]))
    assert find_recurrence(states(psi[100:])) is None


class Stream:
    """Gives a sequence piece by piece and counts what it was asked for."""

    def __init__(self, psi) -> None:
        self.left = states(psi)
        self.given = 0

    def strobe(self, cycles: int):
        self.given += cycles
        piece, self.left = self.left[:cycles], self.left[cycles:]
        return piece


def test_looking_ends_with_the_period_or_with_the_cycles():
    stream = Stream(np.concatenate([np.linspace(-1.0, 0.0, 300), np.full(10_000, 0.7)]))
    seen, found = run_until_recurrent(stream, 10_000)
    assert (found.period, found.transient) == (1, 300)
    assert len(seen) == stream.given == 512
    stream = Stream(np.arange(5000.0))
    seen, found = run_until_recurrent(stream, 1000)
    assert found is None
    assert len(seen) == stream.given == 1000


def drawn(mean: float, seed: int, count: int, cycles: int) -> Transients:
    """Lengths from an exponential distribution beyond 30, seen for so many cycles."""
    lengths = 30.0 + np.random.default_rng(seed).exponential(mean, count)
    settled = lengths < cycles
    return Transients(np.zeros((count, 2)), np.where(settled, lengths, cycles), settled.astype(int), cycles)


@given(mean=st.floats(50.0, 5000.0), seed=st.integers(0, 1000))
@settings(derandomize=True, deadline=None, max_examples=50)
def test_the_mean_escape_time_is_found_within_its_error_though_some_never_escape(mean, seed):
    found = fit_escape_time(drawn(mean, seed, 4000, 5000))
    assert found is not None
    # 50 draws: 4.5 standard errors are passed with probability 3e-4.
    assert abs(found.mean - mean) < 4.5 * found.error
    # Kolmogorov and Smirnov: 2/sqrt(n) is passed with probability 7e-4 at most.
    assert found.distance < 2.0 / np.sqrt(4000)


def test_lengths_that_are_not_exponential_are_far_from_their_fit_and_none_has_no_fit():
    found = fit_escape_time(Transients(np.zeros((500, 2)), np.full(500, 130.0), np.ones(500), 1000))
    assert found is not None
    assert found.mean == 100.0
    assert found.distance > 0.3
    assert fit_escape_time(Transients(np.zeros((3, 2)), np.full(3, 100.0), np.zeros(3), 100)) is None


def test_starts_are_between_the_walls_and_repeat_with_their_seed():
    machine = Machine(gap=0.01)
    starts = draw_starts(machine, 1000, seed=3)
    assert np.all(np.abs(starts) <= [0.01, 0.1])
    assert np.abs(starts).max(axis=0) == pytest.approx([0.01, 0.1], rel=0.02)
    np.testing.assert_array_equal(starts, draw_starts(machine, 1000, seed=3))


THESIS = "as_published"


def test_without_rebound_the_motion_slides_and_repeats_every_cycle():
    # Low friction: both walls are reached in every cycle, and each impact ends the motion's memory.
    found = classify(Machine(damping=0.05, gap=0.01, restitution=0.0), 2000)
    assert (found.kind, found.period, found.slides) == (PERIODIC, 1, True)
    assert "to the last bit" in found.evidence


def test_sustained_chaos_of_the_thesis():
    found = classify(Machine(damping=0.05, gap=0.01, form=THESIS), 5000)
    assert (found.kind, found.period) == (CHAOTIC, 0)
    assert found.exponent > 3.0 * found.uncertainty > 0.0


def test_transient_chaos_of_the_thesis():
    found = classify(Machine(damping=0.025, gap=0.01, form=THESIS), 10_000)
    assert (found.kind, found.period) == (TRANSIENT_CHAOS, 1)
    assert found.transient_exponent > 3.0 * found.transient_uncertainty > 0.0
    assert found.exponent + 3.0 * found.uncertainty < 0.0


def test_a_long_orbit_that_slides_tells_of_chaos_between_its_slides():
    found = classify(Machine(damping=0.228, gap=0.015, form=THESIS), 2000)
    assert (found.kind, found.slides) == (PERIODIC, True)
    assert "chaos that each slide ends" in found.evidence
    assert found.period >= 2 * WINDOW


def test_what_neither_grows_nor_dies_out_is_undecided_and_says_what_helps():
    # No friction, no loss, no forcing: the middle is an orbit that neither attracts nor repels.
    rest = classify(Machine(damping=0.0, gap=0.01, restitution=1.0, xi=0.0, alpha=0.0, beta=0.0), 200)
    assert rest.kind == UNDECIDED
    assert "would help" in rest.evidence
