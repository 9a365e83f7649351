"""The grid: graded along the rolling direction and along the length.

Films form in an inlet that is a b/5 wide at M = 30 and b/200 at M = 1000, and the pressure at an end of the
length changes within a half width b, of which the contact is a hundred long. Even spacings that are fine
enough for either have ten times as many nodes as ones that grow away from there.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from ....core.quantities import Vector
from .faults import out_of_range, require_positive

# Which nodes.
Mask = NDArray[np.bool_]

# Samples of the spacing that nodes and lines are counted by; with more cells than samples the count is wrong.
_SAMPLES = 4000
# Along x steps grow by this share of the distance from the edges of the contact, and outside of it, where
# the pressure is smooth, beyond the level spacing by that share.
_GROWTH, _GROWTH_OUTSIDE = 0.15, 0.15
# What makes a grid coarser.
COARSER = "lower nodes_per_half_width or nodes_per_inlet, or raise end_cell"


@dataclass(frozen=True)
class Resolution:
    """How fine: along x `nodes_per_half_width`, and at the edges of the contact `nodes_per_inlet` if those
    are finer; along y cells of `end_cell` half widths at the ends and kinks, growing by `growth` of the
    distance from there up to length/`fewest_lines`."""

    nodes_per_half_width: float = 20.0
    end_cell: float = 0.1
    growth: float = 0.2
    fewest_lines: int = 40
    nodes_per_inlet: float = 6.0

    def __post_init__(self) -> None:
        require_positive("nodes_per_half_width", self.nodes_per_half_width, "1", "12 are needed, 20 usual")
        require_positive("end_cell", self.end_cell, "half widths", "0.1 is usual")
        require_positive("growth", self.growth, "1", "0.2 is usual")
        require_positive("nodes_per_inlet", self.nodes_per_inlet, "1", "6 give films to 0.5 %")
        if self.fewest_lines < 4:
            raise out_of_range("fewest_lines", self.fewest_lines, "lines", ">= 4", "40 is usual")

    def refined(self, factor: float) -> Resolution:
        """Every spacing divided by `factor`."""
        return Resolution(
            self.nodes_per_half_width * factor, self.end_cell / factor, self.growth / factor,
            max(4, round(self.fewest_lines * factor)), self.nodes_per_inlet * factor,
        )  # fmt: skip


@dataclass(frozen=True)
class Grid:
    """Nodes `x` (m, one at 0) and faces of the cells along the length (m, symmetric about 0).

    Pressure is linear along x between nodes, even along y within a cell.
    """

    x: Vector
    faces: Vector

    @property
    def columns(self) -> Vector:
        """Integrals along x of the nodes' pressures of 1 (m), which are the widths of their cells."""
        steps = np.diff(self.x)
        return 0.5 * (np.append(0.0, steps) + np.append(steps, 0.0))

    @property
    def y(self) -> Vector:
        return 0.5 * (self.faces[1:] + self.faces[:-1])

    @property
    def widths(self) -> Vector:
        return np.diff(self.faces)

    @property
    def areas(self) -> Vector:
        """Of every cell (m^2): (nodes, lines)."""
        return np.outer(self.columns, self.widths)

    @property
    def shape(self) -> tuple[int, int]:
        return len(self.x), len(self.faces) - 1


@dataclass(frozen=True)
class Edges:
    """Where the contact begins and ends along x: half widths from `narrow` to `wide`, with an `inlet` that is
    so wide; any unit."""

    narrow: float
    wide: float
    inlet: float


def _refuse_more(cells: float) -> None:
    """ModelError before more cells in a row are allocated than can be counted."""
    if not cells <= _SAMPLES:
        raise out_of_range("grid", cells, "cells in a row", f"at most {_SAMPLES}", COARSER)


def even_nodes(first: float, last: float, spacing: float) -> Vector:
    """Multiples of `spacing` that cover [first, last]."""
    _refuse_more((last - first) / spacing)
    return np.arange(np.floor(first / spacing), np.ceil(last / spacing) + 1.0) * spacing


def _divide(places: Vector, spacing: Vector, fewest: int) -> Vector:
    """Divide the stretch that `places` sample into steps of `spacing`, without its start."""
    density = 1.0 / spacing
    counted = np.append(0.0, np.cumsum(0.5 * (density[1:] + density[:-1]) * np.diff(places)))
    _refuse_more(float(counted[-1]))
    cells = max(fewest, int(np.ceil(counted[-1])))
    return np.interp(np.linspace(0.0, counted[-1], cells + 1), counted, places)[1:]


def graded_nodes(first: float, last: float, edges: Edges, fine: Resolution) -> Vector:
    """Nodes over [first, last], one at 0, in the unit of a half width."""
    level = 1.0 / fine.nodes_per_half_width
    smallest = min(level, edges.inlet / fine.nodes_per_inlet)

    def side(reach: float) -> Vector:
        x = np.linspace(0.0, reach, _SAMPLES)
        outside = np.maximum(x - edges.wide - edges.inlet, 0.0)
        inside = np.maximum(edges.narrow - edges.inlet - x, 0.0)
        allowed = np.maximum(level, _GROWTH_OUTSIDE * outside)
        return _divide(x, np.minimum(allowed, smallest + _GROWTH * np.maximum(outside, inside)), 3)

    return np.concatenate([-side(-first)[::-1], [0.0], side(last)])


def axial_faces(length: float, half_width: float, kinks: tuple[float, ...], fine: Resolution) -> Vector:
    """Faces on both ends, the middle and all kinks; finest there but in the middle."""
    smallest = fine.end_cell * half_width
    largest = max(length / fine.fewest_lines, smallest)
    marks = [0.0, *sorted(kinks), 0.5 * length]
    sharp = np.array(marks[1:])
    parts = []
    for start, end in pairwise(marks):
        y = np.linspace(start, end, _SAMPLES)
        distance = np.abs(y[:, None] - sharp).min(axis=1)
        parts.append(_divide(y, np.minimum(largest, smallest + fine.growth * distance), 2))
    half = np.concatenate(parts)
    return np.concatenate([-half[::-1], [0.0], half])
