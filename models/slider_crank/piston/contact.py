"""The piston's four corners on the walls of its bore.

Corners are numbered upper front, upper rear, lower front, lower rear; front is away from the crank. With
clearance at most two touch at a time: flat on a wall, or diagonally. Number -1 stands for none.

Contact law, for all touching corners at once (Moreau; Flores, Leine and Glocker 2010, section 3):

    Lambda_N >= 0,  gamma_N+ + e gamma_N- >= 0,  one of them zero,
    |Lambda_T| <= mu Lambda_N, and where gamma_T+ is not zero Lambda_T = -mu Lambda_N sign gamma_T+

(e_T = 0). Lasting contact: N >= 0, gap'' >= 0, one of them zero, with sliding friction.
"""

import math
from typing import Any, NamedTuple

from ...compile.kernel import kernel
from . import mechanics as me
from .mechanics import Coordinates, Symmetric

CORNERS = 4
UPPER, LOWER = 1.0, -1.0
# A bisection's interval is then shorter than rounding.
BISECTIONS = 60


class Motion(NamedTuple):
    """The mechanism at an instant: coordinates q, rates v, and how it answers forces.

    `inverse` maps forces to accelerations (zeros for a crank of given motion). `free`: accelerations without
    walls.
    """

    q: Coordinates
    v: Coordinates
    inverse: Symmetric
    free: Coordinates


class Pair(NamedTuple):
    """A number for each of two touching corners."""

    first: float
    second: float


class Touching(NamedTuple):
    """Numbers of up to two corners."""

    first: int
    second: int


class Push(NamedTuple):
    """What the walls do to up to two corners: normal forces (impulses), and friction over them.

    Numbers of corners stay apart from it: native derivatives take no record that mixes them with forces.
    """

    forces: Pair
    ratios: Pair


@kernel
def side(corner: int) -> float:
    return UPPER if corner < 2 else LOWER


@kernel
def corner_along(corner: int, p: Any) -> float:
    """Place of a corner along the piston, from the middle."""
    return p.half_length if corner % 2 == 0 else -p.half_length


@kernel
def corner_across(corner: int, p: Any) -> float:
    return side(corner) * p.half_height


@kernel
def exists(corner: int, p: Any) -> bool:
    """A piston without length (a roller) has no rear corners of its own."""
    return p.half_length > 0.0 or corner % 2 == 0


@kernel
def gap(corner: int, offset: float, tilt: float, p: Any) -> float:
    """Distance of a corner from its wall; `offset` is that of the piston's middle."""
    raised = offset + corner_along(corner, p) * math.sin(tilt)
    return p.clearance - side(corner) * raised + 2.0 * p.half_height * math.sin(0.5 * tilt) ** 2


@kernel
def gap_rate(corner: int, offset_rate: float, tilt: float, tilt_rate: float, p: Any) -> float:
    raising = offset_rate + corner_along(corner, p) * math.cos(tilt) * tilt_rate
    return -side(corner) * raising + p.half_height * math.sin(tilt) * tilt_rate


@kernel
def normal(corner: int, q: Coordinates, p: Any) -> Coordinates:
    """Derivatives of the gap by the coordinates."""
    row = me.across_row(corner_along(corner, p), corner_across(corner, p), q, p)
    return Coordinates(-side(corner) * row.theta, -side(corner) * row.eta, -side(corner) * row.chi)


@kernel
def tangent(corner: int, q: Coordinates, p: Any) -> Coordinates:
    """Derivatives of the corner's place along the wall by the coordinates."""
    return me.along_row(corner_along(corner, p), corner_across(corner, p), q, p)


@kernel
def sliding_velocity(corner: int, q: Coordinates, v: Coordinates, p: Any) -> float:
    return me.dot(tangent(corner, q, p), v)


@kernel
def wall_push(corner: int, ratio: float, q: Coordinates, p: Any) -> Coordinates:
    """Generalised force of a unit wall force with friction `ratio` times it, towards -x."""
    if corner < 0:
        return Coordinates(0.0, 0.0, 0.0)
    return me.add(normal(corner, q, p), -ratio, tangent(corner, q, p))


@kernel
def coupling(corner: int, other: int, ratio: float, s: Motion, p: Any) -> float:
    """Gap acceleration of `corner` per unit wall force on `other`."""
    if corner < 0 or other < 0:
        return 0.0
    return me.dot(normal(corner, s.q, p), me.multiply(s.inverse, wall_push(other, ratio, s.q, p)))


@kernel
def gap_acceleration(corner: int, acceleration: Coordinates, s: Motion, p: Any) -> float:
    """gap''; 1 for corner -1, so that it needs no force."""
    if corner < 0:
        return 1.0
    turning = me.across_turning(corner_along(corner, p), corner_across(corner, p), s.q, s.v, p)
    return me.dot(normal(corner, s.q, p), acceleration) - side(corner) * turning


@kernel
def solve_holding_forces(a: Pair, b: Pair, w: Pair) -> Pair:
    """z with A z + w = 0; a and b are the rows of A. Corner -1 has zeros in A and gets z = 0."""
    if b.second == 0.0:
        return Pair(-w.first / a.first if a.first != 0.0 else 0.0, 0.0)
    if a.first == 0.0:
        return Pair(0.0, -w.second / b.second)
    determinant = a.first * b.second - a.second * b.first
    return Pair(
        (a.second * w.second - b.second * w.first) / determinant,
        (b.first * w.first - a.first * w.second) / determinant,
    )


@kernel
def solve_complementarity(a: Pair, b: Pair, w: Pair) -> Pair:
    """z >= 0 with A z + w >= 0 and z (A z + w) = 0; a and b are the rows of A.

    Exact, by trying which elements of z are positive. Unique where A is a P-matrix (friction that cannot
    jam the piston); without a solution the better of the single ones.
    """
    if w.first >= 0.0 and w.second >= 0.0:
        return Pair(0.0, 0.0)
    first = -w.first / a.first if w.first < 0.0 and a.first > 0.0 else 0.0
    if first > 0.0 and w.second + b.first * first >= 0.0:
        return Pair(first, 0.0)
    second = -w.second / b.second if w.second < 0.0 and b.second > 0.0 else 0.0
    if second > 0.0 and w.first + a.second * second >= 0.0:
        return Pair(0.0, second)
    both = solve_holding_forces(a, b, w)
    if both.first >= 0.0 and both.second >= 0.0:
        return both
    return Pair(first, 0.0) if w.first < w.second else Pair(0.0, second)


@kernel
def contact_matrix(touching: Touching, ratios: Pair, s: Motion, p: Any) -> tuple[Pair, Pair]:
    """The matrix from wall forces to gap accelerations, or from impulses to jumps of gap rates."""
    i, j = touching.first, touching.second
    return (
        Pair(coupling(i, i, ratios.first, s, p), coupling(i, j, ratios.second, s, p)),
        Pair(coupling(j, i, ratios.first, s, p), coupling(j, j, ratios.second, s, p)),
    )


@kernel
def force_on(corner: int, touching: Touching, push: Push) -> float:
    if corner == touching.first:
        return push.forces.first
    return push.forces.second if corner == touching.second else 0.0


@kernel
def reaction(touching: Touching, push: Push, s: Motion, p: Any) -> Coordinates:
    """Generalised force (impulse) of the walls with their friction."""
    forces, ratios = push
    total = me.add(Coordinates(0.0, 0.0, 0.0), forces.first, wall_push(touching.first, ratios.first, s.q, p))
    return me.add(total, forces.second, wall_push(touching.second, ratios.second, s.q, p))


@kernel
def add_reaction(touching: Touching, push: Push, start: Coordinates, s: Motion, p: Any) -> Coordinates:
    """Accelerations (rates) after wall forces (impulses), from those without."""
    return me.add(start, 1.0, me.multiply(s.inverse, reaction(touching, push, s, p)))


@kernel
def sliding_ratio(corner: int, s: Motion, friction: float, creep: float, p: Any) -> float:
    """Friction over wall force: mu sign(velocity), rounded off within the creep velocity."""
    if corner < 0:
        return 0.0
    return friction * math.tanh(sliding_velocity(corner, s.q, s.v, p) / creep)


@kernel
def free_gap_accelerations(touching: Touching, s: Motion, p: Any) -> Pair:
    """The corners' gap accelerations without walls."""
    return Pair(
        gap_acceleration(touching.first, s.free, s, p), gap_acceleration(touching.second, s.free, s, p)
    )


@kernel
def solve_push(touching: Touching, ratios: Pair, w: Pair, s: Motion, p: Any) -> Push:
    """Forces (impulses) at given friction ratios; w: gap accelerations (rates) without them."""
    a, b = contact_matrix(touching, ratios, s, p)
    return Push(solve_complementarity(a, b, w), ratios)


@kernel
def hold(touching: Touching, ratios: Pair, w: Pair, s: Motion, p: Any) -> Push:
    """Those that keep the corners closed; negative ones would have to pull."""
    a, b = contact_matrix(touching, ratios, s, p)
    return Push(solve_holding_forces(a, b, w), ratios)


@kernel
def slip_power(touching: Touching, push: Push, s: Motion, p: Any) -> float:
    """Sum of normal impulses times sliding velocities after the impact.

    Without impulses (friction jams the piston) a number that sends the bisection away from there.
    """
    found, ratios = push
    if found.first == 0.0 and found.second == 0.0:
        return -ratios.first
    v = add_reaction(touching, push, s.v, s, p)
    total = 0.0
    if found.first > 0.0:
        total += found.first * sliding_velocity(touching.first, s.q, v, p)
    if found.second > 0.0:
        total += found.second * sliding_velocity(touching.second, s.q, v, p)
    return total


@kernel
def slips(touching: Touching, push: Push, s: Motion, p: Any) -> bool:
    """True if there are impulses, and each corner with one slides against its friction afterwards."""
    found, ratios = push
    if found.first == 0.0 and found.second == 0.0:
        return False
    v = add_reaction(touching, push, s.v, s, p)
    if found.first > 0.0 and ratios.first * sliding_velocity(touching.first, s.q, v, p) < 0.0:
        return False
    return not (found.second > 0.0 and ratios.second * sliding_velocity(touching.second, s.q, v, p) < 0.0)


@kernel
def solve_impulses(touching: Touching, w: Pair, friction: float, s: Motion, p: Any) -> Push:
    """Impulses with w = gamma_N- + e gamma_N-: friction is +-friction where sliding goes on, else less.

    Corners that stop together share one ratio: both being closed, they slide at one velocity.
    """
    first = second = friction
    if touching.first >= 0 and sliding_velocity(touching.first, s.q, s.v, p) < 0.0:
        first = -friction
    if touching.second >= 0 and sliding_velocity(touching.second, s.q, s.v, p) < 0.0:
        second = -friction
    for trial in range(4):
        ratios = Pair(first if trial < 2 else -first, second if trial % 2 == 0 else -second)
        push = solve_push(touching, ratios, w, s, p)
        if slips(touching, push, s, p):
            return push
    low, high = -friction, friction
    for _ in range(BISECTIONS):
        middle = 0.5 * (low + high)
        if slip_power(touching, solve_push(touching, Pair(middle, middle), w, s, p), s, p) > 0.0:
            low = middle
        else:
            high = middle
    middle = 0.5 * (low + high)
    return solve_push(touching, Pair(middle, middle), w, s, p)
