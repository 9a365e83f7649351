"""Direct solution of a dense matrix whose blocks away from the diagonal have low rank.

The Jacobian of the contact, J = A + B D with bands A and B and the deflection D, is dense, but two
stretches of the contact act on each other smoothly. The index range is halved again and again down to
leaves; what couples two halves is compressed by adaptive cross approximation to U V^T, and the whole is
solved by block elimination (Woodbury), in O(n log^2 n) operations instead of O(n^3). To RANK columns at
most and COMPRESSION relative to the block, it is an approximation: for Newton's corrections, which only
makes them converge linearly, by about COMPRESSION each time.

J is not formed: its elements follow from the bands and D where they are asked for. Rows are scaled to a
largest element near the diagonal of 1. All is kept by columns, so that what is summed up lies side by side.
"""

from typing import Any, NamedTuple

from ...compile.kernel import kernel, shaped
from ...core.integrator import copy
from ..elimination import add_rows, invert

# Bands reach two nodes to each side.
BAND = 5
# Columns of U and V at most; what is left out of a block, relative to it (a hundred times as much does for
# films of some hundred nodes, not for thousands); nodes in a leaf, about. Cavitated nodes beside the film
# that are divided with it.
RANK = 12
COMPRESSION = 3e-5
LEAF = 24
MARGIN = 4


@kernel
def count_levels(n: int) -> int:
    """How often the range of n nodes is halved."""
    levels = 0
    while LEAF * 2 ** (levels + 1) <= n:
        levels += 1
    return levels


class Jacobian(NamedTuple):
    """A + factor B (D^T + offset 1 weight^T): A and B (BAND, n), element k of row i in column i + k - 2."""

    A: Any
    B: Any
    D: Any
    weight: Any
    factor: float
    offset: float


class Hierarchy(NamedTuple):
    """Factors of a matrix of n rows: views into scratch memory.

    `extent`: first and last + 1 of the rows that are divided; the others are those of the unit matrix.
    `scale` of the rows; `total`: sums over B's rows. `leaf` (leaves, size, size): inverses, transposed.
    Level l pairs 2^l parents' halves: `left` (l, RANK, n) is U, then the halves' inverses times U; `right`
    (l, n, RANK) is V; `rank` (parents, 2) their columns in use and `capacity` (parents, 3, RANK, RANK) what
    `couple` makes of them. The rest is scratch.
    """

    extent: Any
    scale: Any
    total: Any
    leaf: Any
    left: Any
    right: Any
    rank: Any
    capacity: Any
    coupling: Any
    pivot: Any
    rows: Any
    row: Any


def hierarchy_size(n: int) -> int:
    """Elements of scratch that `hierarchy_in` needs."""
    levels = count_levels(n)
    leaves = 2**levels
    size = n // leaves + 1
    per_pair = 3 * RANK**2 + 2
    per_node = 3 + RANK + 2 * levels * RANK
    return 2 + per_node * n + leaves * (size**2 + per_pair) + 3 * RANK + max(size, RANK)


@kernel
def hierarchy_in(work: Any, n: int) -> Hierarchy:
    """Views on the first `hierarchy_size(n)` elements of work."""
    levels = count_levels(n)
    leaves = 2**levels
    size = n // leaves + 1
    extent = work[0:2]
    k = 2
    scale, total, row = work[k : k + n], work[k + n : k + 2 * n], work[k + 2 * n : k + 3 * n]
    k += 3 * n
    rows = shaped(work[k : k + RANK * n], (RANK, n))
    k += RANK * n
    leaf = shaped(work[k : k + leaves * size * size], (leaves, size, size))
    k += leaves * size * size
    left = shaped(work[k : k + levels * n * RANK], (levels, RANK, n))
    k += levels * n * RANK
    right = shaped(work[k : k + levels * n * RANK], (levels, n, RANK))
    k += levels * n * RANK
    rank = shaped(work[k : k + 2 * leaves], (leaves, 2))
    k += 2 * leaves
    capacity = shaped(work[k : k + leaves * 3 * RANK**2], (leaves, 3, RANK, RANK))
    k += leaves * 3 * RANK**2
    coupling = shaped(work[k : k + 3 * RANK], (3, RANK))
    pivot = work[k + 3 * RANK : k + 3 * RANK + max(size, RANK)]
    return Hierarchy(extent, scale, total, leaf, left, right, rank, capacity, coupling, pivot, rows, row)


@kernel
def part_begin(k: int, parts: int, h: Hierarchy) -> int:
    """Where part k of `parts` begins."""
    low, high = int(h.extent[0]), int(h.extent[1])
    return low + k * (high - low) // parts


@kernel
def beside(B: Any, i: int, node: int) -> float:
    """Element of B's row i that belongs to a node, 0 where it is none of the row's."""
    k = node - i + 2
    return B[k, i] if 0 <= k < BAND else 0.0


@kernel
def jacobian_row(i: int, low: int, high: int, J: Jacobian, scale: float, out: Any) -> None:
    """out = scale * J[i, low:high]."""
    n = J.D.shape[0]
    factor = scale * J.factor
    start = min(max(i - 2, 0), n - BAND)
    a, b, c, d, e = (
        factor * beside(J.B, i, start), factor * beside(J.B, i, start + 1),
        factor * beside(J.B, i, start + 2), factor * beside(J.B, i, start + 3),
        factor * beside(J.B, i, start + 4),
    )  # fmt: skip
    total = J.offset * (a + b + c + d + e)
    for j in range(low, high):
        near = J.D[j, start : start + BAND]
        own = a * near[0] + b * near[1] + c * near[2] + d * near[3] + e * near[4]
        out[j - low] = own + total * J.weight[j]
    for j in range(max(i - 2, low), min(i + 3, high)):
        out[j - low] += scale * J.A[j - i + 2, i]


@kernel
def jacobian_column(j: int, low: int, high: int, J: Jacobian, total: Any, out: Any) -> None:
    """out = J[low:high, j]; `total`: sums over B's rows."""
    n = J.D.shape[0]
    everywhere = J.offset * J.weight[j]
    inner = total[low:high]
    for i in range(high - low):
        out[i] = everywhere * inner[i]
    for k in range(BAND):
        first, last = max(low, 2 - k), min(high, n + 2 - k)
        band, near = J.B[k, first:last], J.D[j, first + k - 2 : last + k - 2]
        part = out[first - low : last - low]
        for i in range(part.shape[0]):
            part[i] += band[i] * near[i]
    for i in range(high - low):
        out[i] *= J.factor
    for i in range(max(j - 2, low), min(j + 3, high)):
        out[i - low] += J.A[j - i + 2, i]


@kernel
def compress(low: int, high: int, first: int, last: int, J: Jacobian, h: Hierarchy, U: Any, V: Any) -> int:
    """Rows low to high, columns first to last of J as U[:, rows]^T V[columns]^T; the rank (ACA, row pivots).

    The first pivot row is the one next to the columns, where the block is largest.
    """
    below = low >= last
    i = low if below else high - 1
    norm, rank, tried = 0.0, 0, 0
    scale = h.scale[low:high]
    while rank < RANK and tried < high - low:
        tried += 1
        row, column = h.rows[rank, first:last], U[rank, low:high]
        j, largest = first, 0.0
        # A cavitated node has nothing; the next one, away from the columns, then.
        if h.scale[i] != 0.0:
            jacobian_row(i, first, last, J, h.scale[i], row)
            for q in range(rank):
                h.coupling[0, q] = -U[q, i]
            add_rows(row, h.coupling[0, :rank], h.rows, 0, first)
            for c in range(row.shape[0]):
                if abs(row[c]) > largest:
                    j, largest = first + c, abs(row[c])
        if largest <= 1e-14:
            i = i + 1 if below else i - 1
            if i >= high or i < low:
                break
            continue
        jacobian_column(j, low, high, J, h.total, column)
        for r in range(column.shape[0]):
            column[r] *= scale[r]
        for q in range(rank):
            h.coupling[0, q] = -h.rows[q, j]
        add_rows(column, h.coupling[0, :rank], U, 0, low)
        pivot = 1.0 / row[j - first]
        u2, v2 = 0.0, 0.0
        for r in range(column.shape[0]):
            u2 += column[r] ** 2
        for c in range(row.shape[0]):
            row[c] *= pivot
            v2 += row[c] ** 2
        norm = max(norm, u2 * v2)
        rank += 1
        if u2 * v2 <= (COMPRESSION**2) * norm:
            break
        # The next pivot row: where this column is largest, without the row just done.
        done, largest = i, 0.0
        for r in range(column.shape[0]):
            if low + r != done and abs(column[r]) > largest:
                i, largest = low + r, abs(column[r])
        if largest == 0.0:
            break
    for c in range(first, last):
        for q in range(rank):
            V[c, q] = h.rows[q, c]
    return rank


@kernel
def solve_below(h: Hierarchy, level: int, x: Any, columns: int) -> None:
    """x[:columns] (.., n) times the inverse of J's diagonal blocks, of which there are 2^level; in place.

    x is scaled as J's rows are.
    """
    n = x.shape[1]
    levels = count_levels(n)
    leaves = 2**levels
    for part in range(leaves):
        low, high = part_begin(part, leaves, h), part_begin(part + 1, leaves, h)
        found = h.row[low:high]
        for j in range(columns):
            found[:] = 0.0
            add_rows(found, x[j, low:high], h.leaf[part], 0, 0)
            copy(x[j, low:high], found)
    for above in range(levels - 1, level - 1, -1):
        parents = 2**above
        U, V = h.left[above], h.right[above]
        for parent in range(parents):
            low = part_begin(parent, parents, h)
            middle = part_begin(2 * parent + 1, 2 * parents, h)
            high = part_begin(parent + 1, parents, h)
            pair = parents + parent - 1
            upper, lower = int(h.rank[pair, 0]), int(h.rank[pair, 1])
            to_upper, to_lower, inverse = h.capacity[pair, 0], h.capacity[pair, 1], h.capacity[pair, 2]
            first, second, sent = h.coupling[0, :upper], h.coupling[1, :lower], h.coupling[2, :upper]
            for j in range(columns):
                first[:], second[:], sent[:] = 0.0, 0.0, 0.0
                add_rows(sent, x[j, middle:high], V, middle, 0)
                add_rows(second, x[j, low:middle], V, low, 0)
                add_rows(sent, second, to_upper, 0, 0)
                add_rows(first, sent, inverse, 0, 0)
                add_rows(second, first, to_lower, 0, 0)
                for q in range(upper):
                    first[q] = -first[q]
                for q in range(lower):
                    second[q] = -second[q]
                add_rows(x[j, low:middle], first, U, 0, low)
                add_rows(x[j, middle:high], second, U, 0, middle)


@kernel
def fill_leaf(low: int, high: int, J: Jacobian, fixed: Any, h: Hierarchy, leaf: Any) -> None:
    """leaf = J[low:high, low:high], transposed and its rows scaled; fills their scale."""
    size = high - low
    largest = h.row[low:high]
    for i in range(size):
        largest[i] = 0.0
    for j in range(size):
        column = leaf[j, :size]
        jacobian_column(low + j, low, high, J, h.total, column)
        for i in range(size):
            largest[i] = max(largest[i], abs(column[i]))
    for i in range(size):
        h.scale[low + i] = 1.0 / largest[i] if fixed[low + i] != 1.0 else 0.0
    scale = h.scale[low:high]
    for j in range(size):
        column = leaf[j, :size]
        for i in range(size):
            column[i] *= scale[i]
        if fixed[low + j] == 1.0:
            column[j] = 1.0


@kernel
def couple(
    low: int, middle: int, high: int, U: Any, V: Any, upper: int, lower: int, c: Any, pivot: Any
) -> None:
    """What is left of two halves' coupling, 1 + V^T U with U times the halves' inverses by now, once the
    sources of the lower half are eliminated: `c` is minus what they bring to the upper half, minus what
    those bring to the lower, and the inverse for the upper half's sources; all transposed.
    """
    to_upper, to_lower, inverse = c[0], c[1], c[2]
    for q in range(lower):
        to_upper[q, :upper] = 0.0
        add_rows(to_upper[q, :upper], U[q, middle:high], V, middle, 0)
        for r in range(upper):
            to_upper[q, r] = -to_upper[q, r]
    for q in range(upper):
        to_lower[q, :lower] = 0.0
        add_rows(to_lower[q, :lower], U[q, low:middle], V, low, 0)
        for r in range(lower):
            to_lower[q, r] = -to_lower[q, r]
        inverse[q, :upper] = 0.0
        add_rows(inverse[q, :upper], to_lower[q, :lower], to_upper, 0, 0)
        for r in range(upper):
            inverse[q, r] = (1.0 if q == r else 0.0) - inverse[q, r]
    invert(inverse, upper, pivot)


@kernel
def factorise(J: Jacobian, fixed: Any, h: Hierarchy) -> None:
    """Factors of J into the Hierarchy h; rows where `fixed` is 1 are those of the unit matrix.

    Only the stretch from the first to the last node that is not fixed, and MARGIN more, is divided.
    """
    n = fixed.shape[0]
    levels = count_levels(n)
    leaves = 2**levels
    low, high = n, 0
    for i in range(n):
        if fixed[i] != 1.0:
            low, high = min(low, i), i + 1
        h.scale[i] = 0.0
        h.total[i] = J.B[0, i] + J.B[1, i] + J.B[2, i] + J.B[3, i] + J.B[4, i]
    high = min(high + MARGIN, n)
    h.extent[0], h.extent[1] = max(min(low, high) - MARGIN, 0), high
    for part in range(leaves):
        low, high = part_begin(part, leaves, h), part_begin(part + 1, leaves, h)
        fill_leaf(low, high, J, fixed, h, h.leaf[part])
        invert(h.leaf[part], high - low, h.pivot)
    for level in range(levels - 1, -1, -1):
        parents = 2**level
        U, V = h.left[level], h.right[level]
        columns = 0
        for parent in range(parents):
            low = part_begin(parent, parents, h)
            middle = part_begin(2 * parent + 1, 2 * parents, h)
            high = part_begin(parent + 1, parents, h)
            rank = h.rank[parents + parent - 1]
            rank[0] = compress(low, middle, middle, high, J, h, U, V)
            rank[1] = compress(middle, high, low, middle, J, h, U, V)
            columns = max(columns, int(max(rank[0], rank[1])))
        for parent in range(parents):
            low = part_begin(parent, parents, h)
            middle = part_begin(2 * parent + 1, 2 * parents, h)
            high = part_begin(parent + 1, parents, h)
            rank = h.rank[parents + parent - 1]
            for q in range(int(rank[0]), columns):
                U[q, low:middle] = 0.0
            for q in range(int(rank[1]), columns):
                U[q, middle:high] = 0.0
        solve_below(h, level + 1, U, columns)
        for parent in range(parents):
            low = part_begin(parent, parents, h)
            middle = part_begin(2 * parent + 1, 2 * parents, h)
            high = part_begin(parent + 1, parents, h)
            pair = parents + parent - 1
            upper, lower = int(h.rank[pair, 0]), int(h.rank[pair, 1])
            couple(low, middle, high, U, V, upper, lower, h.capacity[pair], h.pivot)
