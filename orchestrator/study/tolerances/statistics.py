"""Percentiles, yield and Sobol' indices of samples, each with its interval of confidence.

Intervals are those of random samples. Sobol' points fill the space more evenly, so that theirs are no wider.
"""

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy import stats

from models.core.quantities import Vector

CONFIDENCE = 0.95
PERCENTS = (0.1, 1.0, 5.0, 50.0, 95.0, 99.0, 99.9)
# Samples drawn from the sample, for intervals of indices.
RESAMPLES = 400
# Of all trains, those whose value of a factor is nearest to its median.
MIDDLE = 0.2
# Fewer trains in the middle say nothing of their yield.
FEWEST = 20


class Interval(NamedTuple):
    """A value between `low` and `high`; nan: the sample is too small for that end."""

    value: float
    low: float
    high: float


def find_percentile(values: Vector, percent: float) -> Interval:
    """Of values in ascending order; the interval is between two of them, whatever their distribution.

    As many of n values lie below a quantile q as the binomial distribution of n and q says.
    """
    n, share = values.size, percent / 100.0
    if not n:
        return Interval(np.nan, np.nan, np.nan)
    low, high = stats.binom.ppf([0.5 * (1.0 - CONFIDENCE), 0.5 * (1.0 + CONFIDENCE)], n, share)
    # The largest of few values may lie below the quantile with a greater chance than the interval allows.
    ends = (int(low) - 1, int(high))
    below, above = (float(values[k]) if 0 <= k < n else np.nan for k in ends)
    # Interpolation leaves an interval that begins with the last value; `fmax` passes over unknown ends.
    value = np.fmin(np.fmax(np.quantile(values, share), below), above)
    return Interval(float(value), below, above)


def find_yield(good: NDArray[np.bool_]) -> Interval:
    """The share of good trains, with the exact interval of Clopper and Pearson."""
    if not good.size:
        return Interval(np.nan, np.nan, np.nan)
    found = stats.binomtest(int(good.sum()), good.size).proportion_ci(CONFIDENCE)
    return Interval(float(good.mean()), float(found.low), float(found.high))


class Indices(NamedTuple):
    """Of each factor the first and total index, (factors,), with low and high ends, (2, factors)."""

    first: Vector
    total: Vector
    first_interval: Vector
    total_interval: Vector


def find_indices(a: Vector, b: Vector, mixed: Vector, seed: int = 0) -> Indices:
    """Sobol' indices from the values of A and B, (n,), and of A with a factor of B, (factors, n).

    The first by Saltelli et al. (2010), Table 2 (b), the total by Jansen, (f). Rows with a value that is not
    known are left out. Intervals are percentiles over samples of the rows with replacement.
    """
    known = np.isfinite(a) & np.isfinite(b) & np.isfinite(mixed).all(axis=0)
    a, b, mixed = a[known], b[known], mixed[:, known]
    none = np.full(len(mixed), np.nan)
    if a.size < 2 or np.ptp(np.concatenate([a, b])) == 0.0:
        return Indices(none, none, np.array([none, none]), np.array([none, none]))
    centre = np.mean([a, b])
    a, b, mixed = a - centre, b - centre, mixed - centre
    rows = np.random.default_rng(seed).integers(a.size, size=(RESAMPLES, a.size))
    drawn = np.array([_index(a[k], b[k], mixed[:, k]) for k in rows])
    ends = np.quantile(drawn, [0.5 * (1.0 - CONFIDENCE), 0.5 * (1.0 + CONFIDENCE)], axis=0)
    first, total = _index(a, b, mixed)
    return Indices(first, total, ends[:, 0], ends[:, 1])


def _index(a: Vector, b: Vector, mixed: Vector) -> tuple[Vector, Vector]:
    variance = np.var([a, b])
    if variance == 0.0:
        return np.zeros(len(mixed)), np.zeros(len(mixed))
    first = np.mean(b * (mixed - a), axis=1) / variance
    return first, 0.5 * np.mean((mixed - a) ** 2, axis=1) / variance


def find_middle_yield(good: NDArray[np.bool_], shares: Vector) -> Interval:
    """The yield of the trains whose value lies among the middle fifth, by their `shares` of the distribution:
    about that of trains without this tolerance."""
    middle = np.abs(shares - 0.5) <= 0.5 * MIDDLE
    return find_yield(good[middle]) if middle.sum() >= FEWEST else Interval(np.nan, np.nan, np.nan)


class FirstOrder(NamedTuple):
    """Of a figure: its nominal value, mean deviation, and the parts of it of each factor's variance."""

    nominal: float
    deviation: float
    parts: Vector

    def percentile(self, percent: float) -> float:
        return self.nominal + self.deviation * float(stats.norm.ppf(percent / 100.0))


def find_first_order(
    nominal: float, beside: Vector, deviations: Vector, covariances: Mapping[str, Vector]
) -> FirstOrder:
    """As if the figure were linear: from its values (numbers, 2) a deviation less and more of each number."""
    slopes = (beside[:, 1] - beside[:, 0]) / (2.0 * deviations)
    parts, begin = [], 0
    for covariance in covariances.values():
        own = slopes[begin : begin + len(covariance)]
        parts.append(own @ covariance @ own)
        begin += len(covariance)
    variance = float(np.sum(parts))
    share = np.array(parts) / variance if variance > 0.0 else np.full(len(parts), np.nan)
    return FirstOrder(nominal, float(np.sqrt(variance)), share)
