"""Direct solution of a dense matrix whose blocks away from the diagonal have low rank.

The Jacobian of the contact, J = A + B D with bands A and B and the deflection D, is dense, but two
stretches of the contact act on each other smoothly. The index range is halved again and again down to
leaves; what couples two halves is compressed by adaptive cross approximation to U V^T, and the whole is
solved by block elimination (Woodbury), in O(n log^2 n) operations instead of O(n^3). To RANK columns at
most and COMPRESSION relative to the block, it is an approximation: for Newton's corrections, which only
makes them converge linearly, by about COMPRESSION each time.

J is not formed: its elements follow from the bands and D where they are asked for. Rows are scaled to a
largest element near the diagonal of 1.
"""

from __future__ import annotations

from typing import Any, NamedTuple

from ...kernel import kernel

# Bands reach two nodes to each side.
BAND = 5
# Columns of U and V at most; what is left out of a block, relative to it; nodes in a leaf, about.
RANK = 14
COMPRESSION = 1e-5
LEAF = 24


@kernel
def levels_of(n: int) -> int:
    """How often the range of n nodes is halved."""
    levels = 0
    while LEAF * 2 ** (levels + 1) <= n:
        levels += 1
    return levels


class Jacobian(NamedTuple):
    """A + B (D + offset 1 weight^T): A and B (n, BAND), element k of row i in column i + k - 2."""

    A: Any
    B: Any
    D: Any
    weight: Any
    offset: float


class Hierarchy(NamedTuple):
    """Factors of a matrix of n rows: views into scratch memory.

    `extent`: first and last + 1 of the rows that are divided; the others are those of the unit matrix.
    `leaf` (leaves, size, size) and `capacity` (pairs, 2 RANK, 2 RANK) hold LU factors, their rows
    exchanged as in `leaf_pivot` and `capacity_pivot`. Level l pairs 2^l parents' halves: `left` (l, n, RANK)
    is U, then the halves' inverses times U; `right` is V; `rank` (l, parents, 2) their columns in use.
    """

    extent: Any
    scale: Any
    leaf: Any
    leaf_pivot: Any
    left: Any
    right: Any
    rank: Any
    capacity: Any
    capacity_pivot: Any
    coupling: Any
    row: Any
    column: Any


def hierarchy_size(n: int) -> int:
    """Elements of scratch that `hierarchy_in` needs."""
    levels = levels_of(n)
    leaves = 2**levels
    size = n // leaves + 1
    pairs = max(leaves, 1)
    per_pair = (2 * RANK) ** 2 + 2 * RANK + 2
    coupling = 2 * RANK * RANK
    return 2 + n + leaves * size * (size + 1) + 2 * levels * n * RANK + pairs * per_pair + coupling + 2 * n


@kernel
def hierarchy_in(work: Any, n: int) -> Hierarchy:
    """Views on the first `hierarchy_size(n)` elements of work."""
    levels = levels_of(n)
    leaves = 2**levels
    size = n // leaves + 1
    extent = work[0:2]
    k = 2
    scale = work[k : k + n]
    k += n
    leaf = work[k : k + leaves * size * size].reshape((leaves, size, size))
    k += leaves * size * size
    leaf_pivot = work[k : k + leaves * size].reshape((leaves, size))
    k += leaves * size
    left = work[k : k + levels * n * RANK].reshape((levels, n, RANK))
    k += levels * n * RANK
    right = work[k : k + levels * n * RANK].reshape((levels, n, RANK))
    k += levels * n * RANK
    rank = work[k : k + 2 * leaves].reshape((leaves, 2))
    k += 2 * leaves
    capacity = work[k : k + leaves * 4 * RANK * RANK].reshape((leaves, 2 * RANK, 2 * RANK))
    k += leaves * 4 * RANK * RANK
    capacity_pivot = work[k : k + leaves * 2 * RANK].reshape((leaves, 2 * RANK))
    k += leaves * 2 * RANK
    coupling = work[k : k + 2 * RANK * RANK].reshape((2 * RANK, RANK))
    k += 2 * RANK * RANK
    row = work[k : k + n]
    k += n
    column = work[k : k + n]
    return Hierarchy(
        extent, scale, leaf, leaf_pivot, left, right, rank, capacity, capacity_pivot, coupling, row, column
    )


@kernel
def lu(a: Any, pivot: Any, size: int) -> None:
    """LU factors of a[:size, :size] in place, rows exchanged for the largest pivot."""
    for k in range(size):
        best, largest = k, abs(a[k, k])
        for i in range(k + 1, size):
            if abs(a[i, k]) > largest:
                best, largest = i, abs(a[i, k])
        pivot[k] = best
        if best != k:
            for j in range(size):
                a[k, j], a[best, j] = a[best, j], a[k, j]
        inverse = 1.0 / a[k, k]
        for i in range(k + 1, size):
            factor = a[i, k] * inverse
            a[i, k] = factor
            if factor != 0.0:
                for j in range(k + 1, size):
                    a[i, j] -= factor * a[k, j]


@kernel
def lu_solve(a: Any, pivot: Any, size: int, x: Any, first: int, columns: int) -> None:
    """Solve in place for rows first to first + size of x, all of its first columns."""
    for k in range(size):
        best = int(pivot[k])
        if best != k:
            for j in range(columns):
                x[first + k, j], x[first + best, j] = x[first + best, j], x[first + k, j]
    for i in range(1, size):
        for k in range(i):
            factor = a[i, k]
            for j in range(columns):
                x[first + i, j] -= factor * x[first + k, j]
    for i in range(size - 1, -1, -1):
        for k in range(i + 1, size):
            factor = a[i, k]
            for j in range(columns):
                x[first + i, j] -= factor * x[first + k, j]
        inverse = 1.0 / a[i, i]
        for j in range(columns):
            x[first + i, j] *= inverse


@kernel
def bound(k: int, parts: int, h: Hierarchy) -> int:
    """Where part k of `parts` begins."""
    low, high = int(h.extent[0]), int(h.extent[1])
    return low + k * (high - low) // parts


@kernel
def jacobian_row(i: int, low: int, high: int, J: Jacobian, scale: float, out: Any) -> None:
    """out[low:high] = scale * J[i, low:high]."""
    n = J.D.shape[0]
    total = 0.0
    for k in range(BAND):
        total += J.B[i, k]
    total *= scale * J.offset
    for j in range(low, high):
        out[j] = total * J.weight[j]
    for k in range(max(i - 2, 0), min(i + 3, n)):
        b = scale * J.B[i, k - i + 2]
        if b != 0.0:
            for j in range(low, high):
                out[j] += b * J.D[k, j]
    for j in range(max(i - 2, low), min(i + 3, high)):
        out[j] += scale * J.A[i, j - i + 2]


@kernel
def jacobian_column(j: int, low: int, high: int, J: Jacobian, scale: Any, out: Any) -> None:
    """out[low:high] = scale[low:high] * J[low:high, j]."""
    n = J.D.shape[0]
    everywhere = J.offset * J.weight[j]
    for i in range(low, high):
        total = 0.0
        for k in range(max(i - 2, 0), min(i + 3, n)):
            total += J.B[i, k - i + 2] * (J.D[k, j] + everywhere)
        if abs(i - j) <= 2:
            total += J.A[i, j - i + 2]
        out[i] = scale[i] * total


@kernel
def compress(low: int, high: int, first: int, last: int, J: Jacobian, h: Hierarchy, U: Any, V: Any) -> int:
    """Rows low to high, columns first to last of J as U[rows] V[columns]^T; the rank (ACA, row pivots).

    The first pivot row is the one next to the columns, where the block is largest.
    """
    below = low >= last
    i = low if below else high - 1
    norm, rank, tried = 0.0, 0, 0
    row, column = h.row, h.column
    for r in range(low, high):
        column[r] = 0.0
    while rank < RANK and tried < high - low:
        tried += 1
        if h.scale[i] == 0.0:
            # A cavitated node: the next one, away from the columns.
            i = i + 1 if below else i - 1
            if i >= high or i < low:
                break
            continue
        jacobian_row(i, first, last, J, h.scale[i], row)
        for q in range(rank):
            for j in range(first, last):
                row[j] -= U[i, q] * V[j, q]
        j, largest = first, 0.0
        for c in range(first, last):
            if abs(row[c]) > largest:
                j, largest = c, abs(row[c])
        if largest <= 1e-14:
            i = i + 1 if below else i - 1
            if i >= high or i < low:
                break
            continue
        jacobian_column(j, low, high, J, h.scale, column)
        for q in range(rank):
            for r in range(low, high):
                column[r] -= U[r, q] * V[j, q]
        pivot = 1.0 / row[j]
        u2, v2 = 0.0, 0.0
        for r in range(low, high):
            U[r, rank] = column[r]
            u2 += column[r] ** 2
        for c in range(first, last):
            V[c, rank] = row[c] * pivot
            v2 += V[c, rank] ** 2
        norm = max(norm, u2 * v2)
        rank += 1
        if u2 * v2 <= (COMPRESSION**2) * norm:
            break
        # The next pivot row: where this column is largest, without the row just done.
        done, largest = i, 0.0
        for r in range(low, high):
            if r != done and abs(column[r]) > largest:
                i, largest = r, abs(column[r])
        if largest == 0.0:
            break
    return rank


@kernel
def solve_below(h: Hierarchy, level: int, x: Any, columns: int) -> None:
    """x (n, columns) times the inverse of J's diagonal blocks, of which there are 2^level; in place.

    x is scaled as J's rows are.
    """
    n = x.shape[0]
    levels = levels_of(n)
    leaves = 2**levels
    for part in range(leaves):
        low, high = bound(part, leaves, h), bound(part + 1, leaves, h)
        lu_solve(h.leaf[part], h.leaf_pivot[part], high - low, x, low, columns)
    for above in range(levels - 1, level - 1, -1):
        parents = 2**above
        U, V = h.left[above], h.right[above]
        for parent in range(parents):
            low = bound(parent, parents, h)
            middle = bound(2 * parent + 1, 2 * parents, h)
            high = bound(parent + 1, parents, h)
            pair = parents + parent - 1
            upper, lower = int(h.rank[pair, 0]), int(h.rank[pair, 1])
            z = h.coupling
            for p in range(upper + lower):
                for j in range(columns):
                    z[p, j] = 0.0
            for i in range(middle, high):
                for p in range(upper):
                    for j in range(columns):
                        z[p, j] += V[i, p] * x[i, j]
            for i in range(low, middle):
                for p in range(lower):
                    for j in range(columns):
                        z[upper + p, j] += V[i, p] * x[i, j]
            lu_solve(h.capacity[pair], h.capacity_pivot[pair], upper + lower, z, 0, columns)
            for i in range(low, middle):
                for p in range(upper):
                    for j in range(columns):
                        x[i, j] -= U[i, p] * z[p, j]
            for i in range(middle, high):
                for p in range(lower):
                    for j in range(columns):
                        x[i, j] -= U[i, p] * z[upper + p, j]


@kernel
def factorise(J: Jacobian, fixed: Any, h: Hierarchy) -> None:
    """Factors of J into the Hierarchy h; rows where `fixed` is not 0 are those of the unit matrix.

    Only the stretch from the first to the last node that is not fixed is divided.
    """
    n = fixed.shape[0]
    levels = levels_of(n)
    leaves = 2**levels
    low, high = n, 0
    for i in range(n):
        if fixed[i] == 0.0:
            low, high = min(low, i), i + 1
    h.extent[0], h.extent[1] = min(low, high), high
    for part in range(leaves):
        low, high = bound(part, leaves, h), bound(part + 1, leaves, h)
        leaf = h.leaf[part]
        for i in range(low, high):
            if fixed[i] != 0.0:
                h.scale[i] = 0.0
                for j in range(high - low):
                    leaf[i - low, j] = 0.0
                leaf[i - low, i - low] = 1.0
                continue
            jacobian_row(i, low, high, J, 1.0, h.row)
            largest = 0.0
            for j in range(low, high):
                largest = max(largest, abs(h.row[j]))
            h.scale[i] = 1.0 / largest
            for j in range(low, high):
                leaf[i - low, j - low] = h.scale[i] * h.row[j]
        lu(leaf, h.leaf_pivot[part], high - low)
    for level in range(levels - 1, -1, -1):
        parents = 2**level
        U, V = h.left[level], h.right[level]
        columns = 0
        for parent in range(parents):
            low = bound(parent, parents, h)
            middle = bound(2 * parent + 1, 2 * parents, h)
            high = bound(parent + 1, parents, h)
            rank = h.rank[parents + parent - 1]
            upper = compress(low, middle, middle, high, J, h, U, V)
            lower = compress(middle, high, low, middle, J, h, U, V)
            rank[0], rank[1] = upper, lower
            columns = max(columns, max(upper, lower))
            for i in range(low, high):
                for q in range(upper if i < middle else lower, RANK):
                    U[i, q] = 0.0
                for q in range(lower if i < middle else upper, RANK):
                    V[i, q] = 0.0
        solve_below(h, level + 1, U, columns)
        for parent in range(parents):
            low = bound(parent, parents, h)
            middle = bound(2 * parent + 1, 2 * parents, h)
            high = bound(parent + 1, parents, h)
            pair = parents + parent - 1
            upper, lower = int(h.rank[pair, 0]), int(h.rank[pair, 1])
            c = h.capacity[pair]
            for p in range(upper + lower):
                for q in range(upper + lower):
                    c[p, q] = 1.0 if p == q else 0.0
            for i in range(middle, high):
                for p in range(upper):
                    for q in range(lower):
                        c[p, upper + q] += V[i, p] * U[i, q]
            for i in range(low, middle):
                for p in range(lower):
                    for q in range(upper):
                        c[upper + p, q] += V[i, p] * U[i, q]
            lu(c, h.capacity_pivot[pair], upper + lower)
