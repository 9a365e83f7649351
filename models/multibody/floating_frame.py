"""A rod in a floating frame, Q (3): the motion of its frame, and shapes of its deformation.

Of a rod that slides along its axis without turning, the rows of theta and the terms Q_v vanish:

    M_rr r'' + M_rf q_f'' = Q_r,    M_rf^T r'' + M_ff q_f'' + K_ff q_f = Q_f.

The shapes are Legendre's polynomials along the rod, which are orthogonal to each other and to its motion
as a whole: the frame moves with the centre of mass, and M_rf = 0.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from ..core.errors import ModelError
from ..core.quantities import Vector
from .ranges import check_values


class LinearParts(NamedTuple):
    """M and K of the coordinates of small motions."""

    mass: Vector
    stiffness: Vector


@dataclass(frozen=True)
class FloatingRod:
    """A rod (m, m^2, Pa, kg/m^3) with so many shapes; its coordinates are (r, q_1, ..., q_n) (m)."""

    length: float
    area: float
    youngs_modulus: float
    density: float
    shapes: int

    def __post_init__(self) -> None:
        check_values(
            "rod",
            length=self.length,
            area=self.area,
            youngs_modulus=self.youngs_modulus,
            density=self.density,
        )
        if self.shapes < 1:
            raise ModelError(f"rod: shapes = {self.shapes}: must be 1 or more; 6 meet the first frequencies")

    @property
    def matrices(self) -> LinearParts:
        """M_rr = m, M_ff = m/(2 k + 1), K_ff = (2 E A/L) l (l + 1), l = min(j, k), for j + k even."""
        k = np.arange(self.shapes + 1)
        least = np.minimum.outer(k, k)
        even = np.add.outer(k, k) % 2 == 0
        rate = 2.0 * self.youngs_modulus * self.area / self.length
        mass = self.density * self.area * self.length / (2.0 * k + 1.0)
        return LinearParts(np.diag(mass), np.where(even, rate * least * (least + 1.0), 0.0))

    @property
    def ends(self) -> tuple[Vector, Vector]:
        """Rows of the displacement at both ends: (-1)^k and 1."""
        k = np.arange(self.shapes + 1)
        return np.where(k % 2 == 0, 1.0, -1.0), np.ones(k.size)
