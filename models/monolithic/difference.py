"""The difference of two signals, as the whole project states it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..quantities import Vector

# Below this share of its size a signal's spread is rounding, and the signal counts as constant.
CONSTANT = 1e-12


@dataclass(frozen=True)
class Difference:
    """Largest absolute difference, its root mean square, and that over the reference's own spread."""

    max_abs: float
    rms: float
    relative_rms: float


def difference(values: Vector, reference: Vector, nominal: float = 1.0) -> Difference:
    """Compare two signals sampled at the same instants.

    relative_rms = rms(values - reference) / rms(reference - mean(reference)). A constant reference has no
    spread; there the size of the signal takes its place, max(|mean|, nominal).
    """
    values, reference = np.asarray(values, dtype=np.float64), np.asarray(reference, dtype=np.float64)
    if values.shape != reference.shape or values.size == 0:
        raise ValueError(f"signals of shapes {values.shape} and {reference.shape}: must be equal, not empty")
    error = values - reference
    mean = float(np.mean(reference))
    size = max(abs(mean), abs(nominal))
    spread = _rms(reference - mean)
    scale = spread if spread > CONSTANT * size else size
    return Difference(float(np.max(np.abs(error))), _rms(error), _rms(error) / scale)


def _rms(values: Vector) -> float:
    return float(np.sqrt(np.mean(np.square(values))))
