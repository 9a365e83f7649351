"""Rods and beams in a floating frame, Q (3): the motion of the frame, and shapes of the deformation.

Of a part that moves little against a frame at rest the terms Q_v vanish:

    M_rr r'' + M_rf q_f'' = Q_r,    M_rf^T r'' + M_ff q_f'' + K_ff q_f = Q_f,

r with the frame's turn theta where it bends. The shapes are Legendre's polynomials along the part, which are
orthogonal to each other and to its motion as a whole: the frame moves with the centre of mass, and M_rf = 0.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.polynomial import legendre

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


@dataclass(frozen=True)
class FloatingBeam:
    """A round Timoshenko beam that bends in one plane, with so many shapes (m, Pa, kg/m^3; A_y as in Q (2)).

    Deflection and turn of its sections are w = sum w_k P_k and phi = sum phi_k P_k, k = 0 ... shapes; its
    coordinates are (w_0, ..., phi_0, ...) (m, rad). The frame's r is w_0, its theta w_1 = theta L/2 with
    phi_0 = theta, which no stiffness holds.
    """

    length: float
    diameter: float
    youngs_modulus: float
    density: float
    shapes: int
    poissons_ratio: float = 0.3
    shear_factor: float = 10.0 / 9.0

    def __post_init__(self) -> None:
        check_values(
            "beam", length=self.length, diameter=self.diameter, youngs_modulus=self.youngs_modulus,
            density=self.density, poissons_ratio=self.poissons_ratio, shear_factor=self.shear_factor,
        )  # fmt: skip
        if self.shapes < 2 or self.shear_factor == 0.0:
            raise ModelError(
                f"beam: shapes = {self.shapes}, shear_factor = {self.shear_factor:g}: must be 2 or more, and "
                "above 0, e.g. 10/9 for a circle"
            )

    @cached_property
    def matrices(self) -> LinearParts:
        """M = rho A L/(2 k + 1) and rho I L/(2 k + 1); K of E I phi'^2 and (G A/A_y) (w' - phi)^2."""
        area, second = math.pi * self.diameter**2 / 4.0, math.pi * self.diameter**4 / 64.0
        shear = self.youngs_modulus / (2.0 * (1.0 + self.poissons_ratio)) * area / self.shear_factor
        shares = self.length / (2.0 * np.arange(self.shapes + 1) + 1.0)
        mass = self.density * np.concatenate([area * shares, second * shares])
        # Gauss's points make integrals of polynomials of twice the degree exact.
        points, weights = legendre.leggauss(self.shapes + 1)
        at = 0.5 * self.length * points
        slope, turn = np.array([self._slope_at(x) for x in at]), np.array([self.turn_at(x) for x in at])
        curved, sheared = np.roll(slope, self.shapes + 1, axis=1), slope - turn
        rates = 0.5 * self.length * weights[:, None]
        stiffness = self.youngs_modulus * second * curved.T @ (rates * curved)
        return LinearParts(np.diag(mass), stiffness + shear * sheared.T @ (rates * sheared))

    def deflection_at(self, x: float) -> Vector:
        """The row of w at the distance x (m) from the middle."""
        shapes = legendre.legvander(2.0 * x / self.length, self.shapes).ravel()
        return np.concatenate([shapes, np.zeros(self.shapes + 1)])

    def turn_at(self, x: float) -> Vector:
        """The row of phi at the distance x (m) from the middle."""
        return np.roll(self.deflection_at(x), self.shapes + 1)

    def _slope_at(self, x: float) -> Vector:
        """The row of w'."""
        slopes = [legendre.legval(2.0 * x / self.length, legendre.legder(c)) for c in np.eye(self.shapes + 1)]
        return np.concatenate([slopes, np.zeros(self.shapes + 1)]) * 2.0 / self.length
