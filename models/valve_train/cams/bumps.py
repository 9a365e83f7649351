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
    """`count` splines between the cam angles `begin` and `end` (rad), with equally spaced knots."""

    begin: float
    end: float
    count: int

    @property
    def intervals(self) -> int:
        return self.count + 2 * RESTING - DEGREE

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
        every = np.eye(self.count + 2 * RESTING)[:, RESTING:-RESTING]
        return BSpline(self._knots, every, DEGREE, extrapolate=False)

    @cached_property
    def from_equal(self) -> Vector:
        """Each of these splines (columns) as a sum of equal ones (rows), of which the first begins DEGREE
        knots before the event, and each other one knot after the one before."""
        knots = self.begin + self.spacing * np.arange(-DEGREE, self.intervals + DEGREE + 1)
        equal = BSpline(knots, np.eye(self.intervals + DEGREE), DEGREE)
        at = np.linspace(self.begin, self.end, 8 * self.intervals + 1)
        return np.asarray(np.linalg.lstsq(equal(at), self.at(at), rcond=None)[0])

    def equal_place(self, which: int) -> int:
        """The row of `from_equal` that one of the splines inside is alone."""
        return which + RESTING

    def at(self, angles: Vector, derivative: int = 0) -> Vector:
        """Values of all splines (columns) or of a derivative, at cam angles (rows), in any turn."""
        into = self.begin + (angles - self.begin) % TURN
        return np.nan_to_num(self._splines(into, nu=derivative))

    @property
    def areas(self) -> Vector:
        """The integral of each spline over the cam angle (rad)."""
        knots = self._knots[RESTING:-RESTING]
        return np.asarray((knots[DEGREE + 1 :] - knots[: -DEGREE - 1]) / (DEGREE + 1))

    def fit(self, angles: Vector, lift: Vector, curvature: Vector, smoothing: float = 0.0) -> Vector:
        """The coefficients (m) whose lift (m) and second derivative (m/rad^2) are nearest to these, by least
        squares, each over its largest value. `smoothing` weighs the third derivative, over a change of the
        second by its largest value between knots."""
        sizes = float(np.abs(lift).max()), float(np.abs(curvature).max())
        weights = (1.0 / sizes[0], 0), (1.0 / sizes[1], 2), (smoothing * self.spacing / sizes[1], 3)
        matrix = np.vstack([weight * self.at(angles, nu) for weight, nu in weights])
        wanted = np.concatenate([lift / sizes[0], curvature / sizes[1], np.zeros(angles.size)])
        return np.asarray(np.linalg.lstsq(matrix, wanted, rcond=None)[0])
