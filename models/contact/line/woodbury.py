"""Corrections by factors of a Jacobian in which some nodes were still on the other side (cavitated or not).

Where the film moves, a node or two change sides in most iterations, and the Jacobian's rows with them. With
the factors of the old one J0, unit vectors E of these nodes and unknown sources s of them,
x = J0^-1 (b + E s), where s follows from what is asked of these nodes: no change where they cavitate now, the
balance where they no longer do (Woodbury's formula).
"""

from typing import Any, NamedTuple

from ...compile.kernel import kernel, shaped
from ..elimination import add_rows, invert, product
from .hierarchical import Hierarchy, Jacobian, factorise, jacobian_row, solve_below

# Right sides at once: of the balance and of the approach.
SIDES = 2
# Nodes that may have changed sides since the Jacobian was factorised. More hardly ever do.
EXCHANGES = 12


class Exchange(NamedTuple):
    """What is kept beside the factors: views into scratch memory.

    `factored` (n): the sides of the nodes at that time, its first element -1 if there are no factors.
    `answers` (EXCHANGES, n) to unit sources at `nodes`, the first `count[0]` of them.
    """

    factored: Any
    answers: Any
    nodes: Any
    count: Any
    matrix: Any
    wanted: Any
    sources: Any
    pivot: Any


@kernel
def exchange_size(n: int) -> int:
    """Elements of scratch that `exchange_in` needs."""
    return (1 + EXCHANGES) * n + (EXCHANGES + SIDES + 3) * EXCHANGES + 1


@kernel
def exchange_in(work: Any, n: int) -> Exchange:
    """Views on the first `exchange_size(n)` elements of work."""
    k = (1 + EXCHANGES) * n
    small = shaped(work[k : k + (EXCHANGES + SIDES + 3) * EXCHANGES], (EXCHANGES + SIDES + 3, EXCHANGES))
    k += (EXCHANGES + SIDES + 3) * EXCHANGES
    return Exchange(
        work[:n], shaped(work[n : (1 + EXCHANGES) * n], (EXCHANGES, n)), small[EXCHANGES + SIDES],
        work[k : k + 1], small[:EXCHANGES], small[EXCHANGES : EXCHANGES + SIDES],
        small[EXCHANGES + SIDES + 1], small[EXCHANGES + SIDES + 2],
    )  # fmt: skip


@kernel
def factorise_anew(J: Jacobian, fixed: Any, h: Hierarchy, e: Exchange) -> None:
    """Factors of J with the nodes' sides as they are."""
    factorise(J, fixed, h)
    for i in range(fixed.shape[0]):
        e.factored[i] = fixed[i]
    e.count[0] = 0.0


@kernel
def correct_factors(fixed: Any, h: Hierarchy, e: Exchange) -> bool:
    """Correct the factors by answers to sources at nodes that changed sides since; False where they
    cannot: too many have, or one that was not divided with the others.
    """
    if e.factored[0] < 0.0:
        return False
    before = int(e.count[0])
    count = before
    for i in range(fixed.shape[0]):
        if fixed[i] == e.factored[i]:
            continue
        known = False
        for q in range(before):
            known = known or e.nodes[q] == i
        if known:
            continue
        if count == EXCHANGES or not h.extent[0] <= i < h.extent[1]:
            return False
        e.nodes[count] = i
        count += 1
    added = e.answers[before:count]
    for q in range(before, count):
        added[q - before, :] = 0.0
        added[q - before, int(e.nodes[q])] = 1.0
    solve_below(h, 0, added, count - before)
    e.count[0] = count
    return True


@kernel
def fill_matrix(J: Jacobian, fixed: Any, h: Hierarchy, e: Exchange, x: Any) -> None:
    """Equations of the sources, transposed, rows scaled; `x` is the solution without sources."""
    low, high = int(h.extent[0]), int(h.extent[1])
    count, sides = int(e.count[0]), x.shape[0]
    row = h.row[low:high]
    for q in range(count):
        i = int(e.nodes[q])
        if fixed[i] == e.factored[i]:
            # It has come back: no source.
            for r in range(count):
                e.matrix[r, q] = 1.0 if r == q else 0.0
            for side in range(sides):
                e.wanted[side, q] = 0.0
        elif fixed[i] == 1.0:
            for r in range(count):
                e.matrix[r, q] = e.answers[r, i]
            for side in range(sides):
                e.wanted[side, q] = -x[side, i]
        else:
            jacobian_row(i, low, high, J, 1.0, row)
            largest = 0.0
            for k in range(row.shape[0]):
                largest = max(largest, abs(row[k]))
            for r in range(count):
                e.matrix[r, q] = product(e.answers[r, low:high], row) / largest
            for side in range(sides):
                e.wanted[side, q] = (e.wanted[side, q] - product(x[side, low:high], row)) / largest


@kernel
def solve_corrected(J: Jacobian, fixed: Any, h: Hierarchy, e: Exchange, x: Any) -> None:
    """x (at most SIDES, n): right sides, 0 at fixed nodes, become solutions. The factors must be valid."""
    count = int(e.count[0])
    for side in range(x.shape[0]):
        for q in range(count):
            e.wanted[side, q] = x[side, int(e.nodes[q])]
        for i in range(x.shape[1]):
            x[side, i] *= h.scale[i]
    solve_below(h, 0, x, x.shape[0])
    if count == 0:
        return
    fill_matrix(J, fixed, h, e, x)
    invert(e.matrix, count, e.pivot)
    for side in range(x.shape[0]):
        sources = e.sources[:count]
        sources[:] = 0.0
        add_rows(sources, e.wanted[side, :count], e.matrix, 0, 0)
        add_rows(x[side], sources, e.answers, 0, 0)
        for q in range(count):
            if fixed[int(e.nodes[q])] == 1.0:
                x[side, int(e.nodes[q])] = 0.0
