"""The difference of two signals, as the whole project states it."""

from dataclasses import dataclass

import numpy as np

from .quantities import Vector

# Below this share of its size a signal's spread is rounding, and the signal counts as constant.
CONSTANT = 1e-12


@dataclass(frozen=True)
class Difference:
    """Largest absolute difference, its root mean square, and that over the reference's own spread."""

    max_abs: float
    rms: float
    relative_rms: float


def time_weights(times: Vector) -> Vector:
    """The time that each record stands for (s): half of the intervals on both sides of it.

    The first and the last stand for the whole of their one interval, so that records at equal distances
    count equally; a single record counts 1.
    """
    times = np.asarray(times, dtype=np.float64)
    if times.size < 2:
        return np.ones(times.size)
    intervals = np.diff(times)
    return np.asarray(0.5 * (np.append(intervals[0], intervals) + np.append(intervals, intervals[-1])))


def difference(
    values: Vector, reference: Vector, nominal: float = 1.0, weights: Vector | None = None
) -> Difference:
    """Compare two signals sampled at the same instants.

    relative_rms = rms(values - reference) / rms(reference - mean(reference)). A constant reference has no
    spread; there the size of the signal takes its place, max(|mean|, nominal). `weights` (default: equal)
    say how much an instant counts in means: `time_weights` where they are unevenly spaced.
    """
    values, reference = np.asarray(values, dtype=np.float64), np.asarray(reference, dtype=np.float64)
    if values.shape != reference.shape or values.size == 0:
        raise ValueError(f"signals of shapes {values.shape} and {reference.shape}: must be equal, not empty")
    error = values - reference
    mean = float(np.average(reference, weights=weights))
    size = max(abs(mean), abs(nominal))
    spread = _rms(reference - mean, weights)
    scale = spread if spread > CONSTANT * size else size
    rms = _rms(error, weights)
    return Difference(float(np.max(np.abs(error))), rms, rms / scale)


def _rms(values: Vector, weights: Vector | None) -> float:
    return float(np.sqrt(np.average(np.square(values), weights=weights)))
