"""Cavities that keep their oil: the condition of Jakobsson, Floberg and Olsson as a complementarity.

With the filling theta of the gap the mass per area is rho h theta, and everywhere

    p >= 0,    1 - theta >= 0,    p (1 - theta) = 0

(Giacopini et al. 2010). Each node has one unknown: the pressure where oil fills the gap, the layer
m = h theta where it does not (the density is 1 there). Active sets on both are Newton's method on
min(p, 1 - theta) = 0 (Woloszynski et al. 2015 take Fischer and Burmeister's function instead).

Layers are carried along by the mean velocity of the surfaces and depend on no film: their balance is linear
and explicit from node to node. `move_layers` solves it in each iteration, `feed_rows` eliminates it from the
balances of nodes that oil reaches out of a cavity. So pressures stay the only unknowns of the linear system.
"""

from typing import Any, NamedTuple

from ...compile.kernel import kernel
from ..fluid import Lubricant, density_ratio
from .mixed import FED, FED_BEFORE
from .reynolds import Flow, Nodes, carried, cell


@kernel
def keeps_oil(drive: Flow) -> bool:
    """Cavities have layers of oil; otherwise they refill as if full."""
    return drive.supply >= 0.0


@kernel
def entering_layer(h: float, drive: Flow) -> float:
    """The layer (m) at an end of the grid where the gap is h (m)."""
    return min(h, drive.supply)


@kernel
def start_filling(p: Any, h: Any, supply: float, filling: Any) -> None:
    """As full as the layer that enters makes the gap; full where there is pressure."""
    for i in range(filling.shape[0]):
        filling[i] = 1.0 if p[i] > 0.0 else min(1.0, supply / h[i])


@kernel
def find_filled(p: Any, filling: Any, f: Nodes) -> None:
    """How full nodes are: those with pressure wholly."""
    for i in range(filling.shape[0]):
        f.filled[i] = min(filling[i], 1.0) if p[i] == 0.0 else 1.0


@kernel
def fill_partly(p: Any, filling: Any, f: Nodes) -> None:
    """The mass of nodes that are filled so far; that of a cavity does not follow pressure or film."""
    find_filled(p, filling, f)
    for i in range(filling.shape[0]):
        f.mass[i] *= filling[i]
        if p[i] == 0.0:
            f.mass_p[i], f.rho[i] = 0.0, 0.0


@kernel
def spread(masses: Any, X: Any, scale: float, oil: Any) -> None:
    """Layers (m) of these masses of cavities (m2)."""
    for i in range(1, masses.shape[0] - 1):
        oil[i] = masses[i] / (scale * cell(X, i))


@kernel
def hold_layers(h: Any, fixed: Any, drive: Flow, oil: Any, f: Nodes) -> None:
    """Cavitated nodes have the layers `oil`, the ends of the grid what enters there."""
    n = h.shape[0]
    oil[0], oil[n - 1] = entering_layer(h[0], drive), entering_layer(h[n - 1], drive)
    for i in range(n):
        f.filled[i] = 1.0
        if fixed[i] != 0.0:
            f.mass[i], f.mass_p[i], f.rho[i] = oil[i], 0.0, 0.0
            f.filled[i] = min(max(oil[i] / h[i], 0.0), 1.0)


class Ways(NamedTuple):
    """Of the flow of layers through the faces behind the nodes (m/s, to the right positive): derivatives by
    the layer upstream, whose sign tells where that is, and by the one before it."""

    by_near: Any
    by_far: Any


@kernel
def find_ways(X: Any, scale_rate: float, drive: Flow, f: Nodes, ways: Ways) -> None:
    """Fill `ways`."""
    for i in range(X.shape[0] - 1):
        c = carried(X, i, scale_rate, drive, f.filled, 0.5 * (f.drift[i] + f.drift[i + 1]))
        ways.by_near[i] = f.share[i] * c.velocity * (1.0 + c.reach)
        ways.by_far[i] = -f.share[i] * c.velocity * c.reach


@kernel
def flow_of(layers: Any, i: int, ways: Ways) -> float:
    """The flow of layers through the face behind node i (m2/s)."""
    near, step = (i + 1, 1) if ways.by_near[i] < 0.0 else (i, -1)
    far = min(max(near + step, 0), layers.shape[0] - 1)
    return float(ways.by_near[i] * layers[near] + ways.by_far[i] * layers[far])


@kernel
def leaving(i: int, storing: float, ways: Ways) -> float:
    """Derivative of the balance of a cavitated node by its layer; `storing` (m/s): its width over time."""
    return storing + max(ways.by_near[i], 0.0) - min(ways.by_near[i - 1], 0.0)


@kernel
def move_layers(
    X: Any, per_time: float, fixed: Any, ways: Ways, residual: Any, f: Nodes, oil: Any, moved: Any
) -> None:
    """Layers `oil` (m) that balance the cavities, with `residual` and, in `f`, masses and flows.

    Oil flows through each face one way, so that a sweep to the right and one to the left find them.
    `per_time`: the grid's scale over the time step (m/s); `moved`: scratch.
    """
    n = X.shape[0]
    moved[:] = 0.0
    for sweep in range(2):
        for k in range(1, n - 1):
            i = k if sweep == 0 else n - 1 - k
            if fixed[i] != 0.0:
                moved[i] = 0.0
                out = residual[i] + flow_of(moved, i, ways) - flow_of(moved, i - 1, ways)
                moved[i] = -out / leaving(i, per_time * cell(X, i), ways)
    before = flow_of(moved, 0, ways)
    f.through[0] += before
    for i in range(1, n - 1):
        after = flow_of(moved, i, ways)
        f.through[i] += after
        residual[i] += after - before
        before = after
        if fixed[i] != 0.0:
            oil[i] += moved[i]
            f.mass[i] = oil[i]
            residual[i] = 0.0


@kernel
def feed_rows(X: Any, per_time: float, fixed: Any, ways: Ways, A: Any, B: Any, sides: Any) -> None:
    """Layers are eliminated from the derivatives of balances that they feed; their nodes are told by sides.

    Of a cavity only the node next to the film counts: what an outlet gives across a cavity to the next film
    within the step is left to iterations.
    """
    n = fixed.shape[0]
    for j in range(1, n - 1):
        if fixed[j] == 0.0:
            continue
        for step in (-1, 1):
            i, face = j + step, j if step == 1 else j - 1
            near = step * ways.by_near[face]
            if near <= 0.0 or fixed[i] != 0.0:
                continue
            left = leaving(j, per_time * cell(X, j), ways)
            # As the node after the next, through the face behind that.
            far = step * ways.by_far[face + step] if step * ways.by_near[face + step] > 0.0 else 0.0
            sides[i] = FED
            eliminate(A, B, i, j, (near - far) / left)
            if fixed[i + step] == 0.0:
                sides[i + step] = FED_BEFORE
                eliminate(A, B, i + step, j, far / left)


@kernel
def eliminate(A: Any, B: Any, i: int, j: int, factor: float) -> None:
    """Add row j's derivatives to row i's, to those of the same nodes (element k: node i + k - 2)."""
    for k in range(A.shape[0]):
        own = k + j - i
        if 0 <= own < A.shape[0]:
            A[own, i] += factor * A[k, j]
            B[own, i] += factor * B[k, j]


@kernel
def drain_at_the_end(p: Any, first_part: float, weight: float, base: Any, share: Any, through: Any) -> None:
    """Cavities whose `base` for a second stage (m2) is negative lose their oil at that stage's rate alone.

    What flows out of them in the first part of the step (s) is put back, and their faces' share becomes
    `weight`, that of the whole step in the second stage's: of first order there, but no layer is negative.
    """
    n = p.shape[0]
    for sweep in range(4):
        for k in range(1, n - 1):
            i = k if sweep % 2 == 0 else n - 1 - k
            if base[i] >= 0.0 or p[i] > 0.0:
                continue
            for step in (-1, 1):
                face = i if step == 1 else i - 1
                left = step * through[face]
                if left > 0.0 and share[face] == 1.0:
                    share[face] = weight
                    base[i] += first_part * left
                    base[i + step] -= first_part * left


@kernel
def room_left(h: Any, oil: Any, rounding: float, room: Any) -> None:
    """The gap over a cavity's oil (m): negative where it does not hold it."""
    for i in range(h.shape[0]):
        room[i] = h[i] - oil[i]
        if abs(room[i]) <= rounding * h[i]:
            room[i] = 0.0


@kernel
def settle(masses: Any, time_step: float, residual: Any) -> None:
    """Masses become what their balances say, to rounding: what Newton's method left is not lost, but
    balanced in the next step."""
    for i in range(1, masses.shape[0] - 1):
        masses[i] -= residual[i] * time_step


@kernel
def fill_share(
    masses: Any, p: Any, h: Any, X: Any, scale: float, drive: Flow, rho: Any, filling: Any
) -> None:
    """The filling that has these masses, `rho` that of nodes with pressure."""
    n = p.shape[0]
    filling[0] = entering_layer(h[0], drive) / h[0]
    filling[n - 1] = entering_layer(h[n - 1], drive) / h[n - 1]
    for i in range(1, n - 1):
        whole = h[i] if p[i] == 0.0 else rho[i] * h[i]
        filling[i] = masses[i] / (whole * scale * cell(X, i))


@kernel
def volume_on_grid(p: Any, h: Any, filling: Any, X: Any, fluid: Lubricant) -> float:
    """The sum of rho h theta over the nodes' widths in X (m)."""
    total = 0.0
    for i in range(1, X.shape[0] - 1):
        total += filling[i] * density_ratio(p[i], fluid) * h[i] * cell(X, i)
    return total
