"""A contact on a grid, in its equations' units: b along the surfaces, p0 = b/(2 R compliance), b^2/R."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ....core.quantities import Vector
from .contact import FiniteLine, Running
from .grid import Grid, Mask
from .half_space import HalfSpace
from .linear import Closing
from .reynolds import Balance
from .solution import Solution


@dataclass(frozen=True)
class Scaled:
    """`half_width` b (m) is the unit: of the size of the contact's own. `grid` is in units of b."""

    contact: FiniteLine
    running: Running
    half_width: float
    grid: Grid

    @property
    def pressure_unit(self) -> float:
        """p0 (Pa)."""
        return self.half_width / (2.0 * self.running.radius * self.contact.compliance)

    @property
    def film_unit(self) -> float:
        """b^2/R (m)."""
        return self.half_width**2 / self.running.radius

    @cached_property
    def space(self) -> HalfSpace:
        return HalfSpace(self.grid, 1.0 / (2.0 * math.pi))

    @cached_property
    def gap(self) -> Vector:
        """Of the surfaces as they were made, where they touch 0."""
        relief = self.running.relief(self.contact, self.grid.y * self.half_width) / self.film_unit
        return 0.5 * self.grid.x[:, None] ** 2 + relief

    @cached_property
    def balance(self) -> Balance:
        return Balance(self.grid, self.pressure_unit, self.contact.fluid)

    @cached_property
    def open(self) -> Mask:
        """The nodes that may bear pressure: all but the first two columns and the last one."""
        inside = np.ones(self.grid.shape, dtype=bool)
        inside[:2] = inside[-1] = False
        return inside

    @property
    def wedge(self) -> float:
        """12 eta0 |u| R^2 / (b^3 p0)."""
        viscous = 12.0 * self.contact.fluid.viscosity * abs(self.running.velocity)
        return viscous * self.running.radius**2 / (self.half_width**3 * self.pressure_unit)

    @property
    def load(self) -> float:
        """In units of p0 b^2."""
        return self.running.load / (self.pressure_unit * self.half_width**2)

    def carries(self, p: Vector) -> Closing:
        """The closing equation: p carries the load (relative fault)."""
        weights = self.grid.areas / self.load
        return Closing(weights, 0.0, float((weights * p).sum()) - 1.0)

    def solution(self, p: Vector, h: Vector, h0: float, iterations: int) -> Solution:
        """In SI units; a film that moves towards -x is one that moves towards +x seen from behind."""
        b, order = self.half_width, 1
        x = self.grid.x
        if self.running.velocity < 0.0:
            order, x = -1, -x[::-1]
        return Solution(
            self.contact, self.running, Grid(b * x, b * self.grid.faces),
            self.pressure_unit * p[::order], self.film_unit * h[::order], b,
            -self.film_unit * h0, iterations,
        )  # fmt: skip
