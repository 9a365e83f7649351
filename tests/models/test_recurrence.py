"""Recurrence: the period of constructed sequences, whatever comes before them."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from models.slider_crank.motions.recurrence import (
    REPEATS,
    SETTLED,
    TOLERANCE,
    find_recurrence,
    run_until_recurrent,
)


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
def test_the_smallest_period_is_found_exactly(period: int, seed: int, before: int, extra: int) -> None:
    values = orbit(period, seed)
    length = (REPEATS + 1) * period + extra
    start = np.random.default_rng(seed + 1).uniform(-1.0, -0.5, before)
    found = find_recurrence(states(np.concatenate([start, np.resize(values, length)])))
    assert found is not None
    assert (found.period, found.transient, found.exact, found.distance) == (period, before, True, 0.0)
    assert found.repeats == length // period


@given(period=st.integers(1, 12), seed=st.integers(0, 2**32 - 1), rate=st.floats(0.02, 3.0))
@settings(derandomize=True, deadline=None, max_examples=50)
def test_an_orbit_approached_exponentially_is_found_with_its_transient(
    period: int, seed: int, rate: float
) -> None:
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
def test_what_is_and_is_not_the_same_state(sequence, period: int, exact: bool) -> None:
    found = find_recurrence(sequence)
    assert found is not None
    assert (found.period, found.exact) == (period, exact)


@given(st.floats(0.05, 0.95))
@settings(derandomize=True, deadline=None, max_examples=30)
def test_a_logistic_map_in_chaos_does_not_repeat(start: float) -> None:
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


def test_looking_ends_with_the_period() -> None:
    stream = Stream(np.concatenate([np.linspace(-1.0, 0.0, 300), np.full(10_000, 0.7)]))
    seen, found = run_until_recurrent(stream, 10_000)
    assert found is not None
    assert (found.period, found.transient) == (1, 300)
    assert len(seen) == stream.given == 512


def test_looking_ends_with_the_cycles() -> None:
    stream = Stream(np.arange(5000.0))
    seen, found = run_until_recurrent(stream, 1000)
    assert found is None
    assert len(seen) == stream.given == 1000
