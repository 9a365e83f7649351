"""A lift as a sum of quintic B-splines that begin and end an event at rest.

Their second derivatives span the cubic splines of acceleration that are zero at both ends and whose integral
and first moment over the event vanish: the lift closes whatever the coefficients are. The jerk may jump at
both ends, as that of most laws does.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.interpolate import BSpline

from ...core.quantities import Vector
from .table import TURN

DEGREE = 5
# Splines left out at each end, so that lift, velocity and acceleration are zero there.
RESTING = 3


@dataclass(frozen=True)
class Bumps:
    """`splines` between the cam angles `begin` and `end` (rad), with equally spaced knots; where `symmetric`,
    each has the same coefficient as its mirror image."""

    begin: float
    end: float
    splines: int
    symmetric: bool = False

    @property
    def intervals(self) -> int:
        return self.splines + 2 * RESTING - DEGREE

    @cached_property
    def _shares(self) -> Vector:
        """Of the coefficients (columns) in the splines (rows)."""
        every = np.eye(self.splines)
        return np.maximum(every, every[::-1])[:, : self.count] if self.symmetric else every

    @property
    def count(self) -> int:
        """Of coefficients."""
        return (self.splines + 1) // 2 if self.symmetric else self.splines

    @property
    def spacing(self) -> float:
        """Between knots (rad)."""
        return (self.end - self.begin) / self.intervals

    @cached_property
    def _knots(self) -> Vector:
        inner = np.linspace(self.begin, self.end, self.intervals + 1)
        return np.concatenate([np.full(DEGREE, self.begin), inner, np.full(DEGREE, self.end)])

    @cached_property
    def _splines(self) -> BSpline:
        every = np.eye(self.splines + 2 * RESTING)[:, RESTING:-RESTING] @ self._shares
        return BSpline(self._knots, every, DEGREE, extrapolate=False)

    def at(self, angles: Vector, derivative: int = 0) -> Vector:
        """Lift of each coefficient (columns) or a derivative of it, at cam angles (rows), in any turn."""
        into = self.begin + (angles - self.begin) % TURN
        return np.nan_to_num(self._splines(into, nu=derivative))

    @property
    def areas(self) -> Vector:
        """The integral of that over the cam angle (rad)."""
        knots = self._knots[RESTING:-RESTING]
        return np.asarray((knots[DEGREE + 1 :] - knots[: -DEGREE - 1]) / (DEGREE + 1) @ self._shares)

    def fit(self, angles: Vector, lift: Vector, curvature: Vector, smoothing: float = 0.0) -> Vector:
        """The coefficients (m) whose lift (m) and second derivative (m/rad^2) are nearest to these, by least
        squares, each over its largest value. `smoothing` weighs the third derivative, over a change of the
        second by its largest value between knots."""
        sizes = float(np.abs(lift).max()), float(np.abs(curvature).max())
        weights = (1.0 / sizes[0], 0), (1.0 / sizes[1], 2), (smoothing * self.spacing / sizes[1], 3)
        matrix = np.vstack([weight * self.at(angles, nu) for weight, nu in weights])
        wanted = np.concatenate([lift / sizes[0], curvature / sizes[1], np.zeros(angles.size)])
        return np.asarray(np.linalg.lstsq(matrix, wanted, rcond=None)[0])
