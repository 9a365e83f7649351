"""The preconditioner of a Newton step: every line along x with its own deflection, and the flow between.

What is left out is the deflection of a line by the others. The rest is block tridiagonal, with diagonal
blocks beside the diagonal, and solved exactly. (Lines alone do where the film is thin, but where the gap is
wide, as along a tilted contact, the flow between them is all there is.)

Compiled loops in place of LAPACK: a hundred small matrices are inverted by it no faster on one core, and
many times slower where its threads wait for cores that are busy.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from ....compile.kernel import kernel
from ....core.quantities import Vector
from ...elimination import invert
from .grid import Mask
from .reynolds import DOWNSTREAM, HERE, LEFT, RIGHT, UPSTREAM, UPSTREAM_2


@kernel
def _row(by_p: Any, by_h: Any, own: Any, active: Any, i: int, row: Any) -> None:
    """The row of node i, at the active nodes of its line: dG/dp + dG/dh times the line's own influence."""
    here, before, before_2, after = by_h[HERE, i], by_h[UPSTREAM, i], by_h[UPSTREAM_2, i], by_h[DOWNSTREAM, i]
    column = 0
    for k in range(len(active)):
        if active[k]:
            row[column] = here * own[k, i] + before * own[k, i - 1]
            row[column] += before_2 * own[k, i - 2] + after * own[k, i + 1]
            if k == i:
                row[column] += by_p[HERE, i]
            elif k == i - 1:
                row[column] += by_p[UPSTREAM, i]
            elif k == i - 2:
                row[column] += by_p[UPSTREAM_2, i]
            elif k == i + 1:
                row[column] += by_p[DOWNSTREAM, i]
            column += 1


@kernel
def _inverses(
    by_p: Any, by_h: Any, own: Any, active: Any, nodes_of: Any, counts: Any, inverses: Any, order: Any
) -> bool:
    """inverses[j]: of line j's block, less what comes back from the lines before it; transposed."""
    nodes, lines = active.shape
    place = np.empty(nodes, dtype=np.int64)
    work = np.empty((nodes, nodes))
    for j in range(lines):
        n = 0
        for i in range(nodes):
            if active[i, j]:
                _row(by_p[:, :, j], by_h[:, :, j], own[j], active[:, j], i, work[n])
                nodes_of[j, n] = i
                n += 1
        counts[j] = n
        if j > 0:
            for i in range(nodes):
                place[i] = -1
            for m in range(counts[j - 1]):
                place[nodes_of[j - 1, m]] = m
            for a in range(n):
                i = nodes_of[j, a]
                if place[i] >= 0 and by_p[LEFT, i, j] != 0.0:
                    for b in range(n):
                        k = nodes_of[j, b]
                        if place[k] >= 0:
                            back = inverses[j - 1, place[k], place[i]] * by_p[RIGHT, k, j - 1]
                            work[a, b] -= by_p[LEFT, i, j] * back
        if not invert(work, n, order):
            return False
        for a in range(n):
            for b in range(n):
                inverses[j, b, a] = work[a, b]
    return True


@kernel
def _times(inverse: Any, n: int, rows: Any, v: Any, out: Any) -> None:
    """out = inverse v, at the nodes `rows`; column by column, which compilers turn into vector code."""
    for a in range(n):
        out[a] = 0.0
    for b in range(n):
        value = v[rows[b]]
        column = inverse[b]
        for a in range(n):
            out[a] += column[a] * value


@kernel
def _solve(by_p: Any, active: Any, nodes_of: Any, counts: Any, inverses: Any, v: Any) -> None:
    """Forwards and back along the blocks; `v` (lines, nodes) becomes the solution."""
    lines, nodes = v.shape
    found = np.empty(nodes)
    carried = np.zeros(nodes)
    for j in range(lines):
        n = counts[j]
        if j > 0:
            for m in range(n):
                i = nodes_of[j, m]
                v[j, i] -= by_p[LEFT, i, j] * carried[i]
        _times(inverses[j], n, nodes_of[j], v[j], found)
        carried[:] = 0.0
        for m in range(n):
            carried[nodes_of[j, m]] = found[m]
        for m in range(n):
            v[j, nodes_of[j, m]] = found[m]
    for j in range(lines - 2, -1, -1):
        n = counts[j]
        for m in range(n):
            i = nodes_of[j, m]
            carried[i] = by_p[RIGHT, i, j] * v[j + 1, i] if active[i, j + 1] else 0.0
        _times(inverses[j], n, nodes_of[j], carried, found)
        for m in range(n):
            v[j, nodes_of[j, m]] -= found[m]


class Lines:
    """The preconditioner at the active nodes; the others keep their values.

    Active nodes must lie two from the first and one from the last. LinAlgError where a block is singular.
    """

    def __init__(self, by_p: Vector, by_h: Vector, own: Vector, active: Mask) -> None:
        nodes, lines = active.shape
        self._by_p, self._active = by_p, active
        self._inverses = np.empty((lines, nodes, nodes))
        self._nodes_of = np.empty((lines, nodes), dtype=np.int64)
        self._counts = np.empty(lines, dtype=np.int64)
        order = np.empty(nodes, dtype=np.int64)
        if not _inverses(by_p, by_h, own, active, self._nodes_of, self._counts, self._inverses, order):
            raise np.linalg.LinAlgError("a line of the contact is singular")

    def solve(self, v: Vector) -> Vector:
        """The pressures that these equations ask for v (nodes, lines)."""
        found = np.ascontiguousarray(v.T)
        _solve(self._by_p, self._active, self._nodes_of, self._counts, self._inverses, found)
        return found.T
