"""Surface deflection of an elastic half-space under pressures on a graded grid.

The deflection at a node is compliance/pi times the integral of p/r over the surface. Both surfaces of the
contact are half-spaces, also at the ends: a real roller, whose end is free, yields more there.

Along x pressure is linear between nodes, along y even in a cell. Two parts (after Brandt and Lubrecht's
multilevel integration, 1990):

- lines that lie far from each other, against the spacing of an even mesh along x, see each other's pressure
  only as smooth as that mesh: it is brought there, convolved by fast transforms (with zeros, so that it is
  not circular) and a small matrix over the lines for each wave number, and brought back, by cubics;
- of a line's own pressure and of those close to it the integral is taken in closed form (Love 1929).
"""

from __future__ import annotations

import math
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy import fft

from ....compile.kernel import kernel
from ....core.quantities import Vector
from .faults import out_of_range
from .grid import COARSER, Grid

# Lines at least so many spacings of the even mesh apart are far. A cubic errs by (3/128) (spacing^4) times
# the fourth derivative; of 1/r that is 4e-4 of such a line's share, and falls with the fourth power.
_FAR = 6.0
# The matrices of a grid may take so much memory (bytes); the defaults take 0.05 GB, 40 nodes per half width
# with end cells of 0.0125 half widths 0.25 GB.
LARGEST_MEMORY = 4e9
# Gauss's points and weights on (0, 1): three are exact for a hat times a cubic.
_ROOT = math.sqrt(0.15)
_POINTS = np.array([0.5 - _ROOT, 0.5, 0.5 + _ROOT])
_WEIGHTS = np.array([5.0, 8.0, 5.0]) / 18.0


@kernel
def corner(x: float, y: float) -> float:
    """Integral of 1/r over the rectangle from the origin to (x, y); odd in both."""
    along_x = x * math.asinh(y / abs(x)) if x != 0.0 else 0.0
    along_y = y * math.asinh(x / abs(y)) if y != 0.0 else 0.0
    return along_x + along_y


@kernel
def corner_moment(x: float, y: float) -> float:
    """Integral of x/r over it; even in x, odd in y, but for a function of y that a difference in x drops."""
    square = x * x * math.asinh(y / abs(x)) if x != 0.0 else 0.0
    return 0.5 * (y * math.hypot(x, y) + square)


@kernel
def fill_near(x: Any, low: float, high: float, block: Any) -> None:
    """block[i, k]: integral of node k's hat over r from node i, on a strip from low to high along y."""
    n = len(x)
    for i in range(n):
        for k in range(n):
            block[i, k] = 0.0
        left = x[0] - x[i]
        area_left = corner(left, high) - corner(left, low)
        moment_left = corner_moment(left, high) - corner_moment(left, low)
        for k in range(n - 1):
            right = x[k + 1] - x[i]
            area_right = corner(right, high) - corner(right, low)
            moment_right = corner_moment(right, high) - corner_moment(right, low)
            area = area_right - area_left
            rising = (moment_right - moment_left - left * area) / (right - left)
            block[i, k + 1] += rising
            block[i, k] += area - rising
            left, area_left, moment_left = right, area_right, moment_right


@kernel
def _fill_far(spacing: float, y: Any, faces: Any, near: Any, influence: Any) -> None:
    """influence[n, j, l]: integral of 1/r over line l at distance n along x from line j; 0 of near ones."""
    for j in range(len(y)):
        for l in range(len(y)):
            if near[j, l] >= 0:
                for n in range(influence.shape[0]):
                    influence[n, j, l] = 0.0
                continue
            low, high = faces[l] - y[j], faces[l + 1] - y[j]
            influence[0, j, l] = abs(math.log(high / low))
            for n in range(1, influence.shape[0]):
                x = n * spacing
                influence[n, j, l] = math.asinh(high / x) - math.asinh(low / x)


@kernel
def _add_near(near: Any, blocks: Any, p: Any, w: Any) -> None:
    """Add to w (lines, nodes) what near lines' pressures p (lines, nodes) do."""
    lines, n = p.shape
    for j in range(lines):
        for l in range(lines):
            if near[j, l] < 0:
                continue
            block = blocks[near[j, l]]
            first, last = 0, n
            while first < last and p[l, first] == 0.0:
                first += 1
            while last > first and p[l, last - 1] == 0.0:
                last -= 1
            for k in range(first, last):
                value = p[l, k]
                column = block[k]
                for i in range(n):
                    w[j, i] += value * column[i]


def _cubics(at: Vector, start: float, spacing: float, size: int) -> Vector:
    """(at, size): Lagrange's cubic interpolation from an even mesh."""
    place = (at - start) / spacing
    first = np.clip(np.floor(place).astype(int) - 1, 0, size - 4)
    t = place - first
    weights = (
        -(t - 1.0) * (t - 2.0) * (t - 3.0) / 6.0,
        t * (t - 2.0) * (t - 3.0) / 2.0,
        -t * (t - 1.0) * (t - 3.0) / 2.0,
        t * (t - 1.0) * (t - 2.0) / 6.0,
    )
    matrix = np.zeros((len(at), size))
    for k, weight in enumerate(weights):
        matrix[np.arange(len(at)), first + k] = weight
    return matrix


def _gathering(x: Vector, start: float, spacing: float, size: int) -> Vector:
    """(size, nodes): what the nodes' hats put on the even mesh."""
    matrix = np.zeros((size, len(x)))
    for k, (left, right) in enumerate(pairwise(x)):
        pieces = max(1, math.ceil((right - left) / spacing))
        share = ((np.arange(pieces)[:, None] + _POINTS) / pieces).ravel()
        weight = np.tile(_WEIGHTS, pieces) * (right - left) / pieces
        cubics = _cubics(left + share * (right - left), start, spacing, size)
        matrix[:, k] += (weight * (1.0 - share)) @ cubics
        matrix[:, k + 1] += (weight * share) @ cubics
    return matrix


def _spacing(grid: Grid) -> float:
    """Of the even mesh."""
    return float(grid.x[-1] - grid.x[0]) / (max(len(grid.x), 8) - 1)


def _near_pairs(grid: Grid) -> NDArray[np.intp]:
    """Pairs of lines that are near each other."""
    y, faces = grid.y, grid.faces
    gap = np.maximum(faces[None, :-1] - y[:, None], y[:, None] - faces[None, 1:])
    return np.argwhere(gap < _FAR * _spacing(grid))


def refuse_more_memory(grid: Grid) -> None:
    """ModelError before it is allocated: blocks of near lines, own blocks and what a Newton step makes of
    them, influence, its two-sided copy and that one's transform."""
    nodes, lines = grid.shape
    size = 8.0 * ((len(_near_pairs(grid)) + 2 * lines) * nodes**2 + 5 * nodes * lines**2)
    if size > LARGEST_MEMORY:
        name = f"grid of {nodes} x {lines} cells"
        raise out_of_range(name, size, "bytes", f"at most {LARGEST_MEMORY:g}", COARSER)


class HalfSpace:
    """Deflection w (m) of pressures p (Pa) on a grid; `scale` is compliance/pi (1/Pa)."""

    def __init__(self, grid: Grid, scale: float) -> None:
        x, y, faces = grid.x, grid.y, grid.faces
        nodes, self._lines = grid.shape
        self._mesh = max(nodes, 8)
        refuse_more_memory(grid)
        spacing, pairs = _spacing(grid), _near_pairs(grid)
        self._near = np.full((self._lines, self._lines), -1)
        self._blocks = np.empty((len(pairs), nodes, nodes))
        block = np.empty((nodes, nodes))
        for place, (j, l) in enumerate(pairs):
            self._near[j, l] = place
            mirrored = self._near[self._lines - 1 - j, self._lines - 1 - l]
            if mirrored >= 0 and mirrored != place:
                self._blocks[place] = self._blocks[mirrored]
            else:
                fill_near(x, faces[l] - y[j], faces[l + 1] - y[j], block)
                self._blocks[place] = scale * block.T
        self.own = self._blocks[np.diagonal(self._near)]
        """own[j, k, i]: of a line's own pressure at node k on its node i."""
        self._length = fft.next_fast_len(2 * self._mesh, real=True)
        influence = np.empty((self._mesh, self._lines, self._lines))
        _fill_far(spacing, y, faces, self._near, influence)
        # Even in x: the transform is real. What lies beyond the mesh's length is never reached.
        wrapped = np.zeros((self._length, self._lines, self._lines))
        wrapped[: self._mesh] = scale * influence
        wrapped[self._length - self._mesh + 1 :] = scale * influence[:0:-1]
        self._transform = np.ascontiguousarray(fft.rfft(wrapped, axis=0).real)
        self._gather = _gathering(x, float(x[0]), spacing, self._mesh)
        self._spread = _cubics(x, float(x[0]), spacing, self._mesh)

    def deflection(self, p: Vector) -> Vector:
        """w at every node (nodes, lines) of the pressures there."""
        waves = fft.rfft(self._gather @ p, n=self._length, axis=0)
        pairs = waves.view(float).reshape(len(waves), self._lines, 2)
        spread = np.ascontiguousarray(self._transform @ pairs).view(complex)[..., 0]
        far = self._spread @ fft.irfft(spread, n=self._length, axis=0)[: self._mesh]
        w = np.ascontiguousarray(far.T)
        _add_near(self._near, self._blocks, np.ascontiguousarray(p.T), w)
        return w.T
