"""Acceleration of fixed-point iterations v = G(v): none, Aitken, Anderson. All vectors in nominal units."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Protocol

import numpy as np

from models.quantities import Vector


class Acceleration(Protocol):
    """Chooses the next guess."""

    def next(self, guess: Vector, result: Vector) -> Vector:
        """The guess after `guess` gave `result` = G(guess)."""
        ...


class Plain:
    """The result is the next guess."""

    def next(self, guess: Vector, result: Vector) -> Vector:
        return result.copy()


@dataclass
class Aitken:
    """Relaxation v + w (G(v) - v), w by Aitken's rule for vectors (Irons and Tuck 1969)."""

    weight: float = 1.0
    _previous: Vector | None = None

    def next(self, guess: Vector, result: Vector) -> Vector:
        residual = result - guess
        if self._previous is not None:
            change = residual - self._previous
            square = float(change @ change)
            if square > 0.0:
                self.weight *= -float(self._previous @ change) / square
        self._previous = residual
        return np.asarray(guess + self.weight * residual)


@dataclass
class Anderson:
    """Anderson mixing (interface quasi-Newton): least squares over the last `depth` differences."""

    depth: int = 8
    _guesses: list[Vector] = field(default_factory=list)
    _residuals: list[Vector] = field(default_factory=list)

    def next(self, guess: Vector, result: Vector) -> Vector:
        residual = result - guess
        self._guesses.append(guess.copy())
        self._residuals.append(residual)
        if len(self._guesses) > self.depth + 1:
            self._guesses.pop(0)
            self._residuals.pop(0)
        if len(self._guesses) == 1:
            return result.copy()
        d_residual = np.diff(np.column_stack(self._residuals))
        d_result = np.diff(np.column_stack(self._guesses)) + d_residual
        # lstsq cuts directions that are linearly dependent to 1e-10: those only carry rounding.
        weights = np.linalg.lstsq(d_residual, residual, rcond=1e-10)[0]
        return np.asarray(result - d_result @ weights)


ACCELERATIONS: dict[str, type[Plain] | type[Aitken] | type[Anderson]] = {
    "none": Plain,
    "aitken": Aitken,
    "anderson": Anderson,
}
