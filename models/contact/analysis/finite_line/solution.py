"""What comes out: pressure and film on the grid, and the numbers a designer asks for."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ....core.quantities import Vector
from .contact import FiniteLine, Running
from .grid import Grid, Mask

# The ends: so much of the length at either end.
END_SHARE = 0.1


@dataclass(frozen=True)
class Solution:
    """Pressure (Pa) and film (m; of a dry contact the gap) at the nodes (x, y) of `grid`.

    `half_width` (m) is that of a line contact under the load per length where it is carried; `approach` (m)
    of the bodies' far parts, negative where the film holds them apart. `warnings`: what is not to be trusted.
    """

    contact: FiniteLine
    running: Running
    grid: Grid
    pressure: Vector
    film: Vector
    half_width: float
    approach: float
    iterations: int
    warnings: tuple[str, ...] = ()

    @property
    def dry(self) -> bool:
        """The surfaces touch; a steady film is nowhere 0."""
        return self.smallest_film == 0.0

    @property
    def load(self) -> float:
        """N."""
        return float(np.sum(self.pressure * self.grid.areas))

    @property
    def moment(self) -> float:
        """Of the pressure about the middle of the length (N m), positive where +y carries more."""
        return float(np.sum(self.pressure * self.grid.areas * self.grid.y))

    @property
    def load_per_length(self) -> Vector:
        """Along y (N/m)."""
        return self.grid.columns @ self.pressure

    @property
    def peak_along(self) -> Vector:
        """The largest pressure of every line (Pa)."""
        return np.max(self.pressure, axis=0)

    @property
    def least_along(self) -> Vector:
        """The smallest film of every line (m)."""
        return np.min(self.film, axis=0)

    @property
    def middle(self) -> tuple[Vector, Vector]:
        """Pressure and film along x in the middle of the length: the mean of the two lines beside it."""
        pair = slice(self.grid.shape[1] // 2 - 1, self.grid.shape[1] // 2 + 1)
        return self.pressure[:, pair].mean(axis=1), self.film[:, pair].mean(axis=1)

    @property
    def central_film(self) -> float:
        """At x = y = 0 (m)."""
        return float(self.middle[1][np.argmin(np.abs(self.grid.x))])

    @property
    def middle_film(self) -> float:
        """The smallest in the middle of the length (m)."""
        return float(np.min(self.middle[1]))

    @property
    def middle_pressure(self) -> float:
        """The largest in the middle of the length (Pa)."""
        return float(np.max(self.middle[0]))

    @property
    def smallest_film(self) -> float:
        """Of the whole contact (m)."""
        return float(np.min(self.film))

    @property
    def largest_pressure(self) -> float:
        """Of the whole contact (Pa)."""
        return float(np.max(self.pressure))

    @property
    def _at_ends(self) -> Mask:
        return np.abs(self.grid.y) > (0.5 - END_SHARE) * self.contact.length

    @property
    def end_film(self) -> float:
        """The smallest within a tenth of the length from either end (m)."""
        return float(np.min(self.film[:, self._at_ends]))

    @property
    def end_pressure(self) -> float:
        """The largest within a tenth of the length from either end (Pa)."""
        return float(np.max(self.pressure[:, self._at_ends]))
