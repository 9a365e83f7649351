"""Residuals of signals whose offset and gain are unknown: variable projection.

With the model's values m and the data d, the columns A = [m, 1] of the unknown ones have the factors c of
least squares, and the residual is r = d - A c. Its derivative holds for any r, with that of c
(Golub and Pereyra 1973): dc = (A^T A)^-1 (dA^T r - A^T dA c).
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from models.core.quantities import Vector

from .measured import Measured, Signal


@dataclass(frozen=True)
class Eliminated:
    """Residual (n,) of a signal, its derivatives (n, parameters), the best gain and offset."""

    residual: Vector
    jacobian: Vector
    gain: float
    offset: float

    @property
    def size(self) -> float:
        """Root mean square of the residual."""
        return float(np.sqrt(np.mean(self.residual**2)))


def eliminate(signal: Signal, data: Vector, model: Vector, derivatives: Vector) -> Eliminated:
    """Of values (n,) and their derivatives by parameters (n, parameters)."""
    known = np.zeros_like(data) if signal.gain else model
    moved = np.zeros_like(derivatives) if signal.gain else derivatives
    columns = [model] * signal.gain + [np.ones_like(data)] * signal.offset
    if not columns:
        return Eliminated(data - model, -derivatives, 1.0, 0.0)
    # A gain's column is scaled, so that A^T A is well conditioned in any unit.
    scale = float(np.sqrt(np.mean(model**2))) or 1.0
    if signal.gain:
        columns[0] = model / scale
    a = np.stack(columns, axis=1)
    inverse = np.linalg.pinv(a)
    c = inverse @ (data - known)
    residual = data - known - a @ c
    jacobian = -moved + a @ (inverse @ moved)
    if signal.gain:
        da = derivatives / scale
        normal = inverse @ inverse.T
        first = np.zeros((len(columns), derivatives.shape[1]))
        first[0] = da.T @ residual
        jacobian = -c[0] * (da - a @ (inverse @ da)) - a @ (normal @ first)
    gain = float(c[0]) / scale if signal.gain else 1.0
    return Eliminated(residual, jacobian, gain, float(c[-1]) if signal.offset else 0.0)


def eliminate_all(
    measured: Measured, models: Sequence[Vector], derivatives: Sequence[Vector], noises: Sequence[float]
) -> list[Eliminated]:
    """For every signal over all experiments, over its noise (standard deviation).

    Models are (signals, positions) of every experiment, derivatives (signals, positions, parameters).
    """
    found = []
    for i, (signal, noise) in enumerate(zip(measured.signals, noises, strict=True)):
        seen = [np.isfinite(one.values[i]) for one in measured.experiments]
        rows = zip(measured.experiments, models, derivatives, seen, strict=True)
        parts = [(one.values[i][ok], model[i][ok], slope[i][ok]) for one, model, slope, ok in rows]
        data, model, slopes = (np.concatenate(column) for column in zip(*parts, strict=True))
        one = eliminate(signal, data, model, slopes)
        found.append(Eliminated(one.residual / noise, one.jacobian / noise, one.gain, one.offset))
    return found
