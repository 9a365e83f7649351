"""Acceleration of fixed-point iterations v = G(v). All vectors in nominal units.

To add one: a class with `next`, listed in ACCELERATIONS. What it keeps for the next macro step is its warm
start, plain arrays that a checkpoint can store.
"""

from abc import ABC, abstractmethod
from collections.abc import Callable
from typing import Any

import numpy as np

from models.core.quantities import Vector

WarmStart = dict[str, Any]


class Acceleration(ABC):
    """Chooses the next guess."""

    @abstractmethod
    def next(self, guess: Vector, result: Vector) -> Vector:
        """The guess after `guess` gave `result` = G(guess)."""

    def get_warm_start(self) -> WarmStart:
        """What the next macro step begins with."""
        return {}


class Plain(Acceleration):
    """The result is the next guess."""

    def __init__(self, warm_start: WarmStart, step: float) -> None:
        pass

    def next(self, guess: Vector, result: Vector) -> Vector:
        return result.copy()


class Aitken(Acceleration):
    """Relaxation v + w (G(v) - v), w by Aitken's rule for vectors (Irons and Tuck 1969)."""

    def __init__(self, warm_start: WarmStart, step: float) -> None:
        self.weight = 1.0
        self._previous: Vector | None = None

    def next(self, guess: Vector, result: Vector) -> Vector:
        residual = result - guess
        if self._previous is not None:
            change = residual - self._previous
            square = float(change @ change)
            if square > 0.0:
                self.weight *= -float(self._previous @ change) / square
        self._previous = residual
        return np.asarray(guess + self.weight * residual)


class Anderson(Acceleration):
    """Anderson mixing: least squares over the last differences of this macro step."""

    DEPTH = 8

    def __init__(self, warm_start: WarmStart, step: float) -> None:
        self._guess: Vector | None = None
        self._residual: Vector | None = None
        # Rows, newest first: differences of residuals, and of results.
        self.d_residual: Vector | None = None
        self.d_result: Vector | None = None

    def next(self, guess: Vector, result: Vector) -> Vector:
        residual = result - guess
        if self._guess is not None and self._residual is not None:
            change = residual - self._residual
            self.d_residual = self._with(change, self.d_residual)
            self.d_result = self._with(guess - self._guess + change, self.d_result)
        self._guess, self._residual = guess.copy(), residual
        if self.d_residual is None or self.d_result is None:
            return result.copy()
        # lstsq cuts directions that are linearly dependent to 1e-10: those only carry rounding.
        weights = np.linalg.lstsq(self.d_residual.T, residual, rcond=1e-10)[0]
        return np.asarray(result - np.ascontiguousarray(self.d_result.T) @ weights)

    def _with(self, newest: Vector, rows: Vector | None) -> Vector:
        """The newest before the others, as many as are remembered."""
        if rows is None:
            return newest[None]
        return np.concatenate([newest[None], rows[: self.DEPTH - 1]])


class QuasiNewton(Anderson):
    """Interface quasi-Newton by least squares (IQN-ILS; Degroote, Bathe, Vierendeels 2009).

    Anderson mixing that goes on with the differences of the last macro steps, as long as their length stays
    within a factor of REUSED_WITHIN: the interface's Jacobian depends on the step.
    """

    DEPTH = 16
    REUSED_WITHIN = 1.3

    def __init__(self, warm_start: WarmStart, step: float) -> None:
        super().__init__(warm_start, step)
        self._step = step
        length = warm_start.get("step", 0.0)
        if length and 1.0 / self.REUSED_WITHIN < step / length < self.REUSED_WITHIN:
            self.d_residual, self.d_result = warm_start["d_residual"], warm_start["d_result"]

    def get_warm_start(self) -> WarmStart:
        if self.d_residual is None:
            return {}
        return {"step": self._step, "d_residual": self.d_residual, "d_result": self.d_result}


ACCELERATIONS: dict[str, Callable[[WarmStart, float], Acceleration]] = {
    "none": Plain,
    "aitken": Aitken,
    "anderson": Anderson,
    "quasi_newton": QuasiNewton,
}
