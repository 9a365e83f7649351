"""Impacts and releases of the piston's corners as events of a component."""

from typing import Any, NamedTuple

from ...compile.kernel import kernel
from ...core.component import Events
from ...core.quantities import Vector
from . import contact as co
from .contact import CORNERS, Motion, Pair, Push, Touching
from .mechanics import Coordinates, across_row, add, dot
from .motion import Place, find_closed_corners, find_place, friction_ratios, hold_closed

# After an event an open corner is inside its wall by this share of the clearance: a hundred times the
# rounding of a gap.
INSIDE = 1e-13
# Corners nearer than this many times INSIDE to their walls meet them together.
TOGETHER = 10.0
# Bounces lower than this many times INSIDE are rounding; chatter ends there at the latest.
UNRESOLVED = 100.0
# Rates below this share of the mechanism's velocities are rounding of zero.
STILL = 1e-13


@kernel
def find_touching(corner: int, x: Any, place: Place, p: Any) -> Touching:
    """The corner, and another one that is closed or at its wall at the same instant."""
    for i in range(CORNERS):
        near = co.gap(i, place.offset, place.tilt, p) <= TOGETHER * INSIDE * p.clearance
        if i != corner and co.exists(i, p) and (x.closed[i] != 0.0 or near):
            return Touching(corner, i)
    return Touching(corner, -1)


@kernel
def corner_gap_rate(corner: int, place: Place, p: Any) -> float:
    """Gap rate of a corner; 1 for corner -1, so that it gets no impulse."""
    return 1.0 if corner < 0 else co.gap_rate(corner, place.offset_rate, place.tilt, place.tilt_rate, p)


@kernel
def add_restitution(rate: float, restitution: float) -> float:
    """gamma_N- + e gamma_N-, for a corner that approaches."""
    return rate + restitution * min(rate, 0.0)


@kernel
def select_corners(touching: Touching, first: bool, second: bool) -> Touching:
    """The chosen ones of two corners; -1 for the others."""
    return Touching(touching.first if first else -1, touching.second if second else -1)


@kernel
def pressing_acceleration(corner: int, other: int, s: Motion, p: Any) -> float:
    """Acceleration of a corner towards its wall; the other corner's wall counts if it pushes."""
    partner = Touching(-1, other)
    held = hold_closed(partner, s, p)
    pushed = Push(Pair(0.0, max(0.0, held.forces.second)), held.ratios)
    return -co.gap_acceleration(corner, co.add_reaction(partner, pushed, s.free, s, p), s, p)


@kernel
def bounces_end(corner: int, other: int, rebound: float, s: Motion, p: Any) -> bool:
    """True if the bounces after this rebound end within the chatter time, or are lost in rounding."""
    if corner < 0:
        return False
    if rebound <= 0.0:
        return True
    pressed = pressing_acceleration(corner, other, s, p)
    if pressed <= 0.0:
        return False
    soon = 2.0 * rebound <= (1.0 - p.restitution) * pressed * p.chatter_time
    low = rebound**2 <= 2.0 * pressed * UNRESOLVED * INSIDE * p.clearance
    return soon or low


@kernel
def move_inside(x: Any, touching: Touching, p: Any) -> None:
    """Move open corners that touch just inside their walls: the first by offset, the second by tilt."""
    margin = INSIDE * p.clearance
    place = find_place(x, p)
    x.offset = place.offset
    x.tilt = place.tilt
    i, j = touching.first, touching.second
    if i >= 0 and x.closed[i] == 0.0:
        short = margin - co.gap(i, x.offset, x.tilt, p)
        if short > 0.0:
            x.offset -= co.side(i) * short
    if j >= 0 and x.closed[j] == 0.0:
        short = margin - co.gap(j, x.offset, x.tilt, p)
        if short > 0.0:
            turn_by = short / (
                co.gap_rate(j, 0.0, x.tilt, 1.0, p)
                - co.side(i) * co.side(j) * co.gap_rate(i, 0.0, x.tilt, 1.0, p)
            )
            x.tilt += turn_by
            x.offset += co.side(i) * co.gap_rate(i, 0.0, x.tilt, 1.0, p) * turn_by


@kernel
def rate_after(corner: int, touching: Touching, push: Push, s: Motion, p: Any) -> float:
    """Gap rate of a corner after an impact."""
    v = co.add_reaction(touching, push, s.v, s, p)
    place = Place(0.0, dot(across_row(0.0, 0.0, s.q, p), v), s.q.chi, v.chi)
    return corner_gap_rate(corner, place, p)


@kernel
def parting_rate(touching: Touching, push: Push, s: Motion, p: Any) -> float:
    """The larger gap rate of both corners after an impact."""
    first = rate_after(touching.first, touching, push, s, p)
    return max(first, rate_after(touching.second, touching, push, s, p))


@kernel
def speed_scale(v: Coordinates, p: Any) -> float:
    """Velocities from which gap rates are made (m/s)."""
    size = p.half_length + p.half_height
    return p.crank_radius * abs(v.theta) + p.rod_length * abs(v.eta) + size * abs(v.chi)


@kernel
def open_all(x: Any, p: Any) -> None:
    """Write the place into the state and open all corners."""
    place = find_place(x, p)
    x.offset = place.offset
    x.offset_rate = place.offset_rate
    x.tilt = place.tilt
    x.tilt_rate = place.tilt_rate
    for i in range(CORNERS):
        x.closed[i] = 0.0


@kernel
def close_pressed(x: Any, s: Motion, touching: Touching, p: Any) -> None:
    """Close the touching corners whose walls push them."""
    ratios = friction_ratios(touching, s, p)
    forces = co.solve_push(touching, ratios, co.free_gap_accelerations(touching, s, p), s, p).forces
    if forces.first > 0.0:
        x.closed[touching.first] = 1.0
    if forces.second > 0.0:
        x.closed[touching.second] = 1.0


@kernel
def count_event(t: float, x: Any) -> None:
    x.event_count += 1.0
    x.last_event_time = t


@kernel
def release(corner: int, other: int, x: Any, s: Motion, p: Any) -> None:
    """Release a corner whose wall would have to pull; close again what is pressed of it and the other one."""
    close_pressed(x, s, Touching(corner, other), p)
    # To rounding both may be pressed still.
    if x.closed[corner] != 0.0 and (other < 0 or x.closed[other] != 0.0):
        x.closed[corner] = 0.0
    move_inside(x, Touching(other, corner) if other >= 0 else Touching(corner, -1), p)


class Impact(NamedTuple):
    """Impulses of the walls on two corners, and whether the bounces of each end with them."""

    touching: Touching
    push: Push
    first_ends: bool
    second_ends: bool


@kernel
def solve_impact(touching: Touching, rates: Pair, second_closed: bool, s: Motion, p: Any) -> Impact:
    """The impact of corners with these gap rates; the second may have been closed before."""
    i, j = touching.first, touching.second
    e = p.restitution
    w = Pair(add_restitution(rates.first, e), add_restitution(rates.second, e))
    push = co.solve_impulses(touching, w, p.wall_friction, s, p)
    still = STILL * speed_scale(s.v, p)
    after_i = rate_after(i, touching, push, s, p)
    after_j = rate_after(j, touching, push, s, p) if j >= 0 else 1.0
    i_ends = bounces_end(i, j if after_j <= still else -1, after_i - still, s, p)
    j_ends = bounces_end(j, i if after_i <= still else -1, after_j - still, s, p)
    # If its own bounces end, the second one pushes as one at rest does: an impact of the first throws it up.
    i_ends = i_ends or (j_ends and bounces_end(i, j, after_i - still, s, p))
    if i_ends or (j_ends and not second_closed):
        w = Pair(
            add_restitution(rates.first, 0.0 if i_ends else e),
            add_restitution(rates.second, 0.0 if j_ends else e),
        )
        push = co.solve_impulses(touching, w, p.wall_friction, s, p)
    if i_ends and j_ends and parting_rate(touching, push, s, p) > still:
        # One corner would lift the other. The limit of bounces that rock between them holds both.
        push = co.hold(touching, friction_ratios(touching, s, p), rates, s, p)
    return Impact(touching, push, i_ends, j_ends)


@kernel
def apply_impact(t: float, x: Any, impact: Impact, s: Motion, p: Any) -> tuple[Coordinates, Coordinates]:
    """Give the piston its jump of the rates and count it; returns the jump and the walls' impulse."""
    jump = add(co.add_reaction(impact.touching, impact.push, s.v, s, p), -1.0, s.v)
    mean = add(s.v, 0.5, jump)
    walls = co.reaction(impact.touching, impact.push, s, p)
    place = find_place(x, p)
    fastest = 0.0
    for i in range(CORNERS):
        impulse = co.force_on(i, impact.touching, impact.push)
        if impulse != 0.0:
            towards = -corner_gap_rate(i, place, p)
            x.impact_impulse[i] += impulse
            if towards > STILL * speed_scale(s.v, p):
                x.impact_count[i] += 1.0
            fastest = max(fastest, towards)
    x.last_impact_time = t
    x.last_impact_velocity = fastest
    x.impact_loss -= dot(walls, mean)
    x.offset_rate += dot(across_row(0.0, 0.0, s.q, p), jump)
    x.tilt_rate += jump.chi
    return jump, walls


@kernel
def close_after_impact(x: Any, impact: Impact, still: float, s: Motion, p: Any) -> None:
    """Close the corners whose bounces have ended and that are pressed; s is the motion after the impact."""
    touching, place = impact.touching, find_place(x, p)
    resting = select_corners(
        touching,
        impact.first_ends and corner_gap_rate(touching.first, place, p) <= still,
        impact.second_ends and corner_gap_rate(touching.second, place, p) <= still,
    )
    close_pressed(x, s, resting, p)
    if touching.second >= 0 and x.closed[touching.second] != 0.0:
        touching = Touching(touching.second, touching.first)
    move_inside(x, touching, p)


def contact_events(motion: Any, apply_to_crank: Any) -> Events:
    """Events of a component: each corner's gap while open, its wall force while closed.

    motion(x, u, p) -> Motion. apply_to_crank(x, u, s, jump, walls, p) changes the crank's states and energy
    counters after an impact: `jump` of the rates, generalised impulse `walls`.
    """

    @kernel
    def guards(t: float, x: Any, u: Any, p: Any, g: Vector) -> None:
        place, touching = find_place(x, p), find_closed_corners(x)
        for i in range(CORNERS):
            g[i] = co.gap(i, place.offset, place.tilt, p) if co.exists(i, p) else 1.0
        if touching.first >= 0:
            forces = hold_closed(touching, motion(x, u, p), p).forces
            g[touching.first] = forces.first
            if touching.second >= 0:
                g[touching.second] = forces.second

    @kernel
    def strike(t: float, x: Any, u: Any, p: Any, touching: Touching, second_closed: bool) -> None:
        """The first of two corners has reached its wall; all are open in the state."""
        s = motion(x, u, p)
        place = find_place(x, p)
        rates = Pair(corner_gap_rate(touching.first, place, p), corner_gap_rate(touching.second, place, p))
        if rates.first >= 0.0:  # outside the wall by rounding, and already leaving it
            if second_closed:
                close_pressed(x, s, Touching(-1, touching.second), p)
                touching = Touching(touching.second, touching.first)
            move_inside(x, touching, p)
            return
        count_event(t, x)
        impact = solve_impact(touching, rates, second_closed, s, p)
        jump, walls = apply_impact(t, x, impact, s, p)
        apply_to_crank(x, u, s, jump, walls, p)
        close_after_impact(x, impact, STILL * speed_scale(s.v, p), motion(x, u, p), p)

    @kernel
    def transition(k: int, t: float, x: Any, u: Any, p: Any) -> None:
        before = find_closed_corners(x)
        if x.closed[k] != 0.0:
            count_event(t, x)
            open_all(x, p)
            release(k, before.second if before.first == k else before.first, x, motion(x, u, p), p)
        else:
            touching = find_touching(k, x, find_place(x, p), p)
            second_closed = touching.second >= 0 and x.closed[touching.second] != 0.0
            open_all(x, p)
            strike(t, x, u, p, touching, second_closed)

    return Events(CORNERS, guards, transition)
