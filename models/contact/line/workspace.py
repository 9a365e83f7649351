"""Scratch memory of the line contact's solver: one vector, seen as named arrays.

Nothing in it outlives a step but the grid and the deflection matrix, which are the same for all contacts
with as many nodes and are made at the first use.
"""

from typing import Any, NamedTuple

from ...compile.kernel import kernel, shaped
from .grid import fill_kernel_matrix, place_nodes
from .hierarchical import BAND, Hierarchy, hierarchy_in, hierarchy_size
from .mixed import Mixed
from .reynolds import Nodes
from .shear import SOLID_LAYERS, Columns, Heat
from .woodbury import SIDES, Exchange, exchange_in, exchange_size

FIELDS = len(Nodes._fields)
# Vectors besides the grid's two and the properties: those listed in Workspace after `nodes`.
_VECTORS = 21
# Of Mixed.
_MIXED = 8
# Of Heat: over rows, over layers and over nodes; and over rows of one column.
_ROWS, _LAYERS, _STRESSES, _COLUMNS = 11, 7, 11, 4
# Nodes from which heat comes to one.
_BESIDE = 4
# Says that grid and matrix are filled; so much more for every layer.
_FILLED, _PER_LAYER = 0.25, 2.0**-10


class Workspace(NamedTuple):
    """Views, each of n elements where nothing else is said; D (n, n), A and B (BAND, n)
    and solution (SIDES, n) have more."""

    X: Any
    weight: Any
    D: Any
    nodes: Nodes
    residual: Any
    right: Any
    A: Any
    B: Any
    fixed: Any
    solution: Any
    p_start: Any
    h_start: Any
    slope_start: Any
    mass_start: Any
    p_middle: Any
    h_middle: Any
    mass_middle: Any
    base: Any
    rate_start: Any
    estimate: Any
    change: Any
    film_change: Any
    recent: Any
    oil: Any
    filling: Any
    filling_middle: Any
    by_near: Any
    by_far: Any
    hierarchy: Hierarchy
    exchange: Exchange
    mixed: Mixed
    heat: Heat


@kernel
def nodes_in(f: Any) -> Nodes:
    """The first FIELDS rows of f."""
    return Nodes(
        f[0], f[1], f[2], f[3], f[4], f[5], f[6], f[7], f[8], f[9], f[10], f[11], f[12], f[13], f[14], f[15],
        f[16], f[17], f[18],
    )  # fmt: skip


@kernel
def keep_cold(f: Nodes) -> None:
    """The oil is that of the laws."""
    for i in range(f.factor.shape[0]):
        f.factor[i], f.expansion[i] = 1.0, 1.0
        f.drift_0[i], f.drift_p[i], f.drift_left[i], f.drift_right[i] = 0.0, 0.0, 0.0, 0.0


@kernel
def rows_of(layers: int) -> int:
    """Rows of temperatures: those of bodies and of so many layers of the film; 0: isothermal."""
    return 2 * SOLID_LAYERS + layers if layers > 0 else 0


@kernel
def heat_size(n: int, layers: int) -> int:
    """Elements of scratch that `heat_in` needs."""
    rows = rows_of(layers)
    come = _BESIDE * (layers + 2) if layers > 0 else 0
    return n * (_ROWS * rows + _LAYERS * layers + _STRESSES + come) + _COLUMNS * rows


@kernel
def heat_in(work: Any, n: int, layers: int) -> Heat:
    """Views on the first `heat_size(n, layers)` elements of work."""
    rows = rows_of(layers)
    size = n * rows
    k = _ROWS * size
    t = shaped(work[:k], (_ROWS, n, rows))
    v = shaped(work[k : k + _LAYERS * n * layers], (_LAYERS, n, layers))
    k += _LAYERS * n * layers
    s = shaped(work[k : k + _STRESSES * n], (_STRESSES, n))
    k += _STRESSES * n
    beside = layers + 2 if layers > 0 else 0
    come = shaped(work[k : k + _BESIDE * n * beside], (n, beside, _BESIDE))
    k += _BESIDE * n * beside
    one = shaped(work[k : k + _COLUMNS * rows], (_COLUMNS, rows))
    columns = Columns(t[5], t[6], t[7], t[8], t[9], come, s[9:11], v[4], s[8], one[0], one[1], one[2], one[3])
    return Heat(
        work[:size], work[10 * size : 11 * size], work[4 * size : 5 * size], t[0], t[1], t[2], t[3],
        v[0], v[1], v[2], v[3], v[5], v[6], s[0], s[1], s[2], s[3], s[4], s[5], s[6], s[7], columns,
    )  # fmt: skip


def workspace_size(n: int, layers: int = 0) -> int:
    """Elements of scratch that `workspace_in` needs."""
    rows = 2 + n + FIELDS + _VECTORS + _MIXED + 2 * BAND + SIDES
    return 1 + rows * n + hierarchy_size(n) + exchange_size(n) + int(heat_size(n, layers))


@kernel
def workspace_in(work: Any, n: int, layers: int = 0) -> Workspace:
    """Views on the first `workspace_size(n, layers)` elements of work; fills grid and matrix if need be."""
    X, weight = work[1 : 1 + n], work[1 + n : 1 + 2 * n]
    k = 1 + 2 * n
    D = shaped(work[k : k + n * n], (n, n))
    k += n * n
    tag = n + _FILLED + _PER_LAYER * layers
    fresh = work[0] != tag
    if fresh:
        place_nodes(X)
        fill_kernel_matrix(X, weight, D)
        work[0] = tag
    fields = shaped(work[k : k + (FIELDS + _VECTORS) * n], (FIELDS + _VECTORS, n))
    k += (FIELDS + _VECTORS) * n
    m = shaped(work[k : k + _MIXED * n], (_MIXED, n))
    k += _MIXED * n
    A = shaped(work[k : k + BAND * n], (BAND, n))
    k += BAND * n
    B = shaped(work[k : k + BAND * n], (BAND, n))
    k += BAND * n
    solution = shaped(work[k : k + SIDES * n], (SIDES, n))
    k += SIDES * n
    exchange = exchange_in(work[k:], n)
    k += exchange_size(n)
    heat = heat_in(work[k:], n, layers)
    k += heat_size(n, layers)
    f, v = fields, fields[FIELDS:]
    nodes = nodes_in(f)
    nodes.filled[:] = 1.0
    nodes.share[:] = 1.0
    if fresh:
        keep_cold(nodes)
    mixed = Mixed(m[0], m[1], m[2], m[3], m[4], m[5], m[6], m[7])
    return Workspace(
        X, weight, D, nodes, v[0], v[13], A, B, v[1], solution, v[2], v[3], v[4], v[5], v[6], v[7],
        v[8], v[9], v[10], v[11], v[12], v[14], v[15], v[16], v[17], v[18],
        v[19], v[20], hierarchy_in(work[k:], n), exchange, mixed, heat,
    )  # fmt: skip
