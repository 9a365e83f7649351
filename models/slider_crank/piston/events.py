"""Impacts and releases of the piston's corners as events of a component."""

from typing import Any, NamedTuple

from ...compile.kernel import kernel
from ...core.component import Events
from ...core.quantities import Vector
from . import contact as co
from .contact import CORNERS, Motion, Pair, Push, Touching
from .mechanics import Coordinates, Machine, across_row, add, dot
from .motion import Place, find_closed_corners, find_place, friction_ratios, hold_closed, machine

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
def find_touching(corner: int, x: Any, place: Place, m: Machine) -> Touching:
    """The corner, and another one that is closed or at its wall at the same instant."""
    for i in range(CORNERS):
        near = co.gap(i, place.offset, place.tilt, m) <= TOGETHER * INSIDE * m.clearance
        if i != corner and co.exists(i, m) and (x.closed[i] != 0.0 or near):
            return Touching(corner, i)
    return Touching(corner, -1)


@kernel
def corner_gap_rate(corner: int, place: Place, m: Machine) -> float:
    """Gap rate of a corner; 1 for corner -1, so that it gets no impulse."""
    return 1.0 if corner < 0 else co.gap_rate(corner, place.offset_rate, place.tilt, place.tilt_rate, m)


@kernel
def add_restitution(rate: float, restitution: float) -> float:
    """gamma_N- + e gamma_N-, for a corner that approaches."""
    return rate + restitution * min(rate, 0.0)


@kernel
def select_corners(touching: Touching, first: bool, second: bool) -> Touching:
    """The chosen ones of two corners; -1 for the others."""
    return Touching(touching.first if first else -1, touching.second if second else -1)


@kernel
def pressing_acceleration(corner: int, other: int, s: Motion, p: Any, m: Machine) -> float:
    """Acceleration of a corner towards its wall; the other corner's wall counts if it pushes."""
    partner = Touching(-1, other)
    held = hold_closed(partner, s, p, m)
    pushed = Push(Pair(0.0, max(0.0, held.forces.second)), held.ratios)
    return -co.gap_acceleration(corner, co.add_reaction(partner, pushed, s.free, s, m), s, m)


@kernel
def bounces_end(corner: int, other: int, rebound: float, s: Motion, p: Any, m: Machine) -> bool:
    """True if the bounces after this rebound end within the chatter time, or are lost in rounding."""
    if corner < 0:
        return False
    if rebound <= 0.0:
        return True
    pressed = pressing_acceleration(corner, other, s, p, m)
    if pressed <= 0.0:
        return False
    soon = 2.0 * rebound <= (1.0 - p.restitution) * pressed * p.chatter_time
    low = rebound**2 <= 2.0 * pressed * UNRESOLVED * INSIDE * m.clearance
    return soon or low


@kernel
def move_inside(x: Any, touching: Touching, m: Machine) -> None:
    """Move open corners that touch just inside their walls: the first by offset, the second by tilt."""
    margin = INSIDE * m.clearance
    place = find_place(x, m)
    x.offset = place.offset
    x.tilt = place.tilt
    i, j = touching.first, touching.second
    if i >= 0 and x.closed[i] == 0.0:
        short = margin - co.gap(i, x.offset, x.tilt, m)
        if short > 0.0:
            x.offset -= co.side(i) * short
    if j >= 0 and x.closed[j] == 0.0:
        short = margin - co.gap(j, x.offset, x.tilt, m)
        if short > 0.0:
            turn_by = short / (
                co.gap_rate(j, 0.0, x.tilt, 1.0, m)
                - co.side(i) * co.side(j) * co.gap_rate(i, 0.0, x.tilt, 1.0, m)
            )
            x.tilt += turn_by
            x.offset += co.side(i) * co.gap_rate(i, 0.0, x.tilt, 1.0, m) * turn_by


@kernel
def rate_after(corner: int, touching: Touching, push: Push, s: Motion, m: Machine) -> float:
    """Gap rate of a corner after an impact."""
    v = co.add_reaction(touching, push, s.v, s, m)
    place = Place(0.0, dot(across_row(0.0, 0.0, s.q, m), v), s.q.chi, v.chi)
    return corner_gap_rate(corner, place, m)


@kernel
def parting_rate(touching: Touching, push: Push, s: Motion, m: Machine) -> float:
    """The larger gap rate of both corners after an impact."""
    first = rate_after(touching.first, touching, push, s, m)
    return max(first, rate_after(touching.second, touching, push, s, m))


@kernel
def speed_scale(v: Coordinates, m: Machine) -> float:
    """Velocities from which gap rates are made (m/s)."""
    size = m.half_length + m.half_height
    return m.crank_radius * abs(v.theta) + m.rod_length * abs(v.eta) + size * abs(v.chi)


@kernel
def open_all(x: Any, m: Machine) -> None:
    """Write the place into the state and open all corners."""
    place = find_place(x, m)
    x.offset = place.offset
    x.offset_rate = place.offset_rate
    x.tilt = place.tilt
    x.tilt_rate = place.tilt_rate
    for i in range(CORNERS):
        x.closed[i] = 0.0


@kernel
def close_pressed(x: Any, s: Motion, p: Any, touching: Touching, m: Machine) -> None:
    """Close the touching corners whose walls push them."""
    ratios = friction_ratios(touching, s, p, m)
    forces = co.solve_push(touching, ratios, co.free_gap_accelerations(touching, s, m), s, m).forces
    if forces.first > 0.0:
        x.closed[touching.first] = 1.0
    if forces.second > 0.0:
        x.closed[touching.second] = 1.0


@kernel
def count_event(t: float, x: Any) -> None:
    x.event_count += 1.0
    x.last_event_time = t


@kernel
def release(corner: int, other: int, x: Any, s: Motion, p: Any, m: Machine) -> None:
    """Release a corner whose wall would have to pull; close again what is pressed of it and the other one."""
    close_pressed(x, s, p, Touching(corner, other), m)
    # To rounding both may be pressed still.
    if x.closed[corner] != 0.0 and (other < 0 or x.closed[other] != 0.0):
        x.closed[corner] = 0.0
    move_inside(x, Touching(other, corner) if other >= 0 else Touching(corner, -1), m)


class Impact(NamedTuple):
    """Impulses of the walls on two corners, and whether the bounces of each end with them."""

    touching: Touching
    push: Push
    first_ends: bool
    second_ends: bool


@kernel
def solve_impact(
    touching: Touching, rates: Pair, second_closed: bool, s: Motion, p: Any, m: Machine
) -> Impact:
    """The impact of corners with these gap rates; the second may have been closed before."""
    i, j = touching.first, touching.second
    e = p.restitution
    w = Pair(add_restitution(rates.first, e), add_restitution(rates.second, e))
    push = co.solve_impulses(touching, w, p.wall_friction, s, m)
    still = STILL * speed_scale(s.v, m)
    after_i = rate_after(i, touching, push, s, m)
    after_j = rate_after(j, touching, push, s, m) if j >= 0 else 1.0
    i_ends = bounces_end(i, j if after_j <= still else -1, after_i - still, s, p, m)
    j_ends = bounces_end(j, i if after_i <= still else -1, after_j - still, s, p, m)
    # If its own bounces end, the second one pushes as one at rest does: an impact of the first throws it up.
    i_ends = i_ends or (j_ends and bounces_end(i, j, after_i - still, s, p, m))
    if i_ends or (j_ends and not second_closed):
        w = Pair(
            add_restitution(rates.first, 0.0 if i_ends else e),
            add_restitution(rates.second, 0.0 if j_ends else e),
        )
        push = co.solve_impulses(touching, w, p.wall_friction, s, m)
    if i_ends and j_ends and parting_rate(touching, push, s, m) > still:
        # One corner would lift the other. The limit of bounces that rock between them holds both.
        push = co.hold(touching, friction_ratios(touching, s, p, m), rates, s, m)
    return Impact(touching, push, i_ends, j_ends)


@kernel
def apply_impact(t: float, x: Any, impact: Impact, s: Motion, m: Machine) -> tuple[Coordinates, Coordinates]:
    """Give the piston its jump of the rates and count it; returns the jump and the walls' impulse."""
    jump = add(co.add_reaction(impact.touching, impact.push, s.v, s, m), -1.0, s.v)
    mean = add(s.v, 0.5, jump)
    walls = co.reaction(impact.touching, impact.push, s, m)
    place = find_place(x, m)
    fastest = 0.0
    for i in range(CORNERS):
        impulse = co.force_on(i, impact.touching, impact.push)
        if impulse != 0.0:
            towards = -corner_gap_rate(i, place, m)
            x.impact_impulse[i] += impulse
            if towards > STILL * speed_scale(s.v, m):
                x.impact_count[i] += 1.0
            fastest = max(fastest, towards)
    x.last_impact_time = t
    x.last_impact_velocity = fastest
    x.impact_loss -= dot(walls, mean)
    x.offset_rate += dot(across_row(0.0, 0.0, s.q, m), jump)
    x.tilt_rate += jump.chi
    return jump, walls


@kernel
def close_after_impact(x: Any, impact: Impact, still: float, s: Motion, p: Any, m: Machine) -> None:
    """Close the corners whose bounces have ended and that are pressed; s is the motion after the impact."""
    touching, place = impact.touching, find_place(x, m)
    resting = select_corners(
        touching,
        impact.first_ends and corner_gap_rate(touching.first, place, m) <= still,
        impact.second_ends and corner_gap_rate(touching.second, place, m) <= still,
    )
    close_pressed(x, s, p, resting, m)
    if touching.second >= 0 and x.closed[touching.second] != 0.0:
        touching = Touching(touching.second, touching.first)
    move_inside(x, touching, m)


def contact_events(motion: Any, apply_to_crank: Any) -> Events:
    """Events of a component: each corner's gap while open, its wall force while closed.

    motion(x, u, p) -> Motion. apply_to_crank(x, u, s, jump, walls, m) changes the crank's states and energy
    counters after an impact: `jump` of the rates, generalised impulse `walls`.
    """

    @kernel
    def guards(t: float, x: Any, u: Any, p: Any, g: Vector) -> None:
        m = machine(p)
        place, touching = find_place(x, m), find_closed_corners(x)
        for i in range(CORNERS):
            g[i] = co.gap(i, place.offset, place.tilt, m) if co.exists(i, m) else 1.0
        if touching.first >= 0:
            forces = hold_closed(touching, motion(x, u, p), p, m).forces
            g[touching.first] = forces.first
            if touching.second >= 0:
                g[touching.second] = forces.second

    @kernel
    def strike(t: float, x: Any, u: Any, p: Any, touching: Touching, second_closed: bool) -> None:
        """The first of two corners has reached its wall; all are open in the state."""
        m, s = machine(p), motion(x, u, p)
        place = find_place(x, m)
        rates = Pair(corner_gap_rate(touching.first, place, m), corner_gap_rate(touching.second, place, m))
        if rates.first >= 0.0:  # outside the wall by rounding, and already leaving it
            if second_closed:
                close_pressed(x, s, p, Touching(-1, touching.second), m)
                touching = Touching(touching.second, touching.first)
            move_inside(x, touching, m)
            return
        count_event(t, x)
        impact = solve_impact(touching, rates, second_closed, s, p, m)
        jump, walls = apply_impact(t, x, impact, s, m)
        apply_to_crank(x, u, s, jump, walls, m)
        close_after_impact(x, impact, STILL * speed_scale(s.v, m), motion(x, u, p), p, m)

    @kernel
    def transition(k: int, t: float, x: Any, u: Any, p: Any) -> None:
        m, before = machine(p), find_closed_corners(x)
        if x.closed[k] != 0.0:
            count_event(t, x)
            open_all(x, m)
            release(k, before.second if before.first == k else before.first, x, motion(x, u, p), p, m)
        else:
            touching = find_touching(k, x, find_place(x, m), m)
            second_closed = touching.second >= 0 and x.closed[touching.second] != 0.0
            open_all(x, m)
            strike(t, x, u, p, touching, second_closed)

    return Events(CORNERS, guards, transition)
