"""The grid: even along the rolling direction, graded along the length.

The pressure at an end changes within a half width b, the contact is a hundred b long: an even axial spacing
fine enough for the ends has ten times as many lines as one that grows away from them.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from ...quantities import Vector
from .faults import positive, within

# Which nodes.
Mask = NDArray[np.bool_]

# Samples of the spacing along the length that the lines are counted by.
_SAMPLES = 4000


@dataclass(frozen=True)
class Resolution:
    """How fine: `nodes_per_half_width` in x; in y cells of `end_cell` half widths at the ends and kinks,
    growing by `growth` of the distance from there up to length/`fewest_lines`."""

    nodes_per_half_width: float = 20.0
    end_cell: float = 0.1
    growth: float = 0.2
    fewest_lines: int = 40

    def __post_init__(self) -> None:
        positive("nodes_per_half_width", self.nodes_per_half_width, "1", "12 or more are needed, 20 give 1 %")
        positive("end_cell", self.end_cell, "half widths", "0.1 is usual")
        positive("growth", self.growth, "1", "0.2 is usual")
        if self.fewest_lines < 4:
            raise within("fewest_lines", self.fewest_lines, "lines", ">= 4", "40 is usual")

    def refined(self, factor: float) -> Resolution:
        """Every spacing divided by `factor`."""
        return Resolution(
            self.nodes_per_half_width * factor, self.end_cell / factor, self.growth / factor,
            max(4, round(self.fewest_lines * factor)),
        )  # fmt: skip


@dataclass(frozen=True)
class Grid:
    """Nodes `x` (m, even, one at 0) and faces of the cells along the length (m, symmetric about 0)."""

    x: Vector
    faces: Vector

    @property
    def spacing(self) -> float:
        return float(self.x[1] - self.x[0])

    @property
    def y(self) -> Vector:
        return 0.5 * (self.faces[1:] + self.faces[:-1])

    @property
    def widths(self) -> Vector:
        return np.diff(self.faces)

    @property
    def areas(self) -> Vector:
        """Area of every line's cells (m^2)."""
        return self.spacing * self.widths

    @property
    def shape(self) -> tuple[int, int]:
        return len(self.x), len(self.faces) - 1


def even_nodes(first: float, last: float, spacing: float) -> Vector:
    """Multiples of `spacing` that cover [first, last]."""
    return np.arange(np.floor(first / spacing), np.ceil(last / spacing) + 1.0) * spacing


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
        density = 1.0 / np.minimum(largest, smallest + fine.growth * distance)
        counted = np.append(0.0, np.cumsum(0.5 * (density[1:] + density[:-1]) * np.diff(y)))
        cells = max(2, int(np.ceil(counted[-1])))
        parts.append(np.interp(np.linspace(0.0, counted[-1], cells + 1), counted, y)[1:])
    half = np.concatenate(parts)
    return np.concatenate([-half[::-1], [0.0], half])
