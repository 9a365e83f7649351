"""Motion between two walls: flights, impacts, chatter and sliding.

In y, the slider's distance from the middle, the walls stand still (in psi they move), and F's impact law
(2.17) is y' -> -e y'. A flight is a power series in each cell of the revolution; a wall is reached where
the series says, found by steps that cannot pass a root. At a wall the distance to it is divided by u, so
that a bounce of any height has its duration to full relative accuracy.

Bounces on a pressing wall get lower by e each; sliding begins when what remains of them, 2 v / ((1-e) A),
is shorter than CHATTER_LEFT: their limit point. Sliding ends where the pressing acceleration falls to
zero. No decision depends on a step size.
"""

import math
from typing import Any, NamedTuple

from ...compile.kernel import kernel
from ..equations import rod_cosine
from .series import (
    NEVER,
    TERMS,
    bounds_of_bend,
    divide_by_u,
    first_fall,
    move_origin,
    next_fall,
    value,
    value_and_slope,
)

# Places in a position: cell, fraction of it, y, y' per radian, and the side on which the slider slides.
CELL, FRACTION, Y, RATE_OF_Y, SIDE, POSITION_SIZE = 0, 1, 2, 3, 4, 5
FREE, UPPER, LOWER = 0.0, 1.0, -1.0
# What `next_event` returns.
END, UPPER_IMPACT, LOWER_IMPACT, RELEASE = 0, 1, 2, 3
# Chatter ends when its remainder is shorter than this crank angle (rad). A plastic impact replaces it:
# impulse, energy loss and place are those of the bounces, but for the change of the pressing acceleration
# in that time, 1e-8 of it. Sliding that would end within that time is missed or added.
CHATTER_LEFT = 1e-8
# With restitution above 1 - ELASTIC bounces hardly get lower by themselves, but friction, on a wall that
# presses all the time, makes exponentially more of them; those shorter than ELASTIC (rad), and so not 1e-12
# high, are rest.
ELASTIC = 1e-6
# This part of a cell after the zero of the pressing acceleration it is negative beyond rounding; the
# slider, released from rest, is then some 1e-33 off.
PAST_ZERO = 1e-11
# Distances from a wall below this part of it are rounding.
ON_WALL = 4e-15
# Rows of scratch: a flight's series, a quotient, and what flights need for themselves.
FLIGHT, QUOTIENT, OWN, SCRATCH_ROWS = 0, 1, 2, 8


class Walls(NamedTuple):
    """Walls at y = upper and y = -lower."""

    upper: float
    lower: float
    restitution: float
    threshold: float  # rebound (psi' per radian) below which a pressed slider slides (F: 0.005)


@kernel
def wall_of(side: float, walls: Walls) -> float:
    """Distance of the wall on that side from the middle."""
    return walls.upper if side == UPPER else walls.lower


@kernel
def chatter_ends(rebound: float, pressing: float, restitution: float) -> bool:
    """True if the bounces that remain, in all 2 v / ((1-e) A) long, are shorter than CHATTER_LEFT; of elastic
    ones if the next is shorter than ELASTIC."""
    lost = 1.0 - restitution
    left = CHATTER_LEFT * lost if lost >= ELASTIC else ELASTIC
    return pressing >= 0.0 and 2.0 * rebound <= left * pressing


@kernel
def time_to_wall(side: float, c: Any, low: float, high: float, wall: float, length: float, q: Any) -> float:
    """The first u in [0, length] at which the flight c reaches the wall; NEVER if it does not.

    low and high bound its second derivative; q is scratch.
    """
    bend = -high if side == UPPER else low
    distance = wall - side * c[0]
    slope = -side * c[1]
    if distance <= ON_WALL * wall:
        if slope < 0.0:
            return 0.0
        divide_by_u(c, side, q)
        return next_fall(q, length)
    if distance + min(0.0, length * (slope + 0.5 * min(0.0, bend) * length)) > 0.0:
        return NEVER
    return first_fall(c, side, wall, bend, length)


@kernel
def pressing_at(flow: Any, position: Any, side: float) -> float:
    """Acceleration towards the wall on that side of a slider that rests on it, per radian squared."""
    return value(flow.pressing[int(position[CELL]), 0 if side == UPPER else 1], position[FRACTION])


@kernel
def phase(flow: Any, position: Any) -> float:
    """Crank angle in the revolution."""
    return (position[CELL] + position[FRACTION]) * (2.0 * math.pi / flow.pressing.shape[0])


@kernel
def move(flow: Any, position: Any, c: Any, length: float) -> None:
    """Advance a free slider by `length` of the cell along its series."""
    y, slope = value_and_slope(c, length)
    position[FRACTION] += length
    position[Y] = y
    position[RATE_OF_Y] = slope * flow.pressing.shape[0] / (2.0 * math.pi)


@kernel
def slide(flow: Any, position: Any, length: float, c: Any) -> bool:
    """Advance a sliding slider by `length` of the cell; True if it is released before."""
    pressing = flow.pressing[int(position[CELL]), 0 if position[SIDE] == UPPER else 1]
    for i in range(TERMS):
        c[i] = pressing[i]
    if position[FRACTION] > 0.0:
        move_origin(c, position[FRACTION])
    low, _ = bounds_of_bend(c, length)
    at = first_fall(c, -1.0, 0.0, low, length) + PAST_ZERO
    if at > length:
        position[FRACTION] += length
        return False
    position[FRACTION] += at
    position[SIDE] = FREE
    return True


@kernel
def strike(flow: Any, walls: Walls, position: Any, side: float) -> None:
    """The impact on that side: y' -> -e y', and sliding if it is the last one."""
    wall = wall_of(side, walls)
    pressing = pressing_at(flow, position, side)
    rebound = walls.restitution * max(0.0, side * position[RATE_OF_Y])
    slow = pressing > 0.0 and rebound <= walls.threshold * rod_cosine(phase(flow, position), flow.xi)
    position[Y] = side * wall
    if slow or chatter_ends(rebound, pressing, walls.restitution):
        position[RATE_OF_Y] = 0.0
        position[SIDE] = side
    else:
        position[RATE_OF_Y] = -side * rebound


@kernel
def pass_event(flow: Any, walls: Walls, position: Any, code: int) -> float:
    """Make the transition of an event; returns its side."""
    if code == RELEASE:
        return UPPER if position[Y] > 0.0 else LOWER
    side = UPPER if code == UPPER_IMPACT else LOWER
    strike(flow, walls, position, side)
    return side


def make_next_event(flight: Any, skip: Any) -> Any:
    """next_event(flow, walls, position, cell, fraction, scratch) -> what happened.

    It advances the position to the next event, or to that fraction of that cell: END. At an impact y' is
    still the one before it; at a release the slider is free. A position at the end of the last cell is
    (cells, 0). scratch: (SCRATCH_ROWS, TERMS).

    flight(flow, position, scratch) leaves the series of y from the position on in scratch[FLIGHT] and returns
    how much of a cell it is good for;
    skip(flow, walls, position) crosses a whole cell if it can tell that no wall is reached in it.
    """

    @kernel
    def next_event(flow: Any, walls: Walls, position: Any, cell: int, fraction: float, scratch: Any) -> int:
        c, q = scratch[FLIGHT], scratch[QUOTIENT]
        while True:
            k = int(position[CELL])
            stop = fraction if k == cell else 1.0
            length = stop - position[FRACTION]
            if k > cell or (k == cell and length <= 0.0):
                return END
            if length <= 0.0:
                position[CELL] = k + 1.0
                position[FRACTION] = 0.0
                continue
            if position[SIDE] == FREE:
                if length == 1.0 and skip(flow, walls, position):
                    continue
                good = flight(flow, position, scratch)
                cut = good < length
                length = min(good, length)
                low, high = bounds_of_bend(c, length)
                up = time_to_wall(UPPER, c, low, high, walls.upper, length, q)
                down = time_to_wall(LOWER, c, low, high, walls.lower, min(up, length), q)
                at = min(up, down)
                if at <= length:
                    move(flow, position, c, at)
                    return UPPER_IMPACT if up < down else LOWER_IMPACT
                move(flow, position, c, length)
                if cut:
                    continue
            elif slide(flow, position, length, c):
                return RELEASE
            if stop == 1.0:
                position[CELL] = k + 1.0
                position[FRACTION] = 0.0

    return next_event
