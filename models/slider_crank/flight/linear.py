"""Flights and tangent vectors of the linear forms, along the tabulated `flow`."""

import math
from typing import Any

from ...compile.kernel import kernel
from .bouncing import CELL, FLIGHT, FRACTION, RATE_OF_Y, Walls, Y, pressing_at
from .flow import OFFSET, PARTICULAR, RATE, Flow
from .series import TERMS, move_origin, value_and_slope


@kernel
def flight(flow: Flow, position: Any, scratch: Any) -> float:
    """Series of y from the position on, in scratch[FLIGHT], good for the cell."""
    c = scratch[FLIGHT]
    k, u = int(position[CELL]), position[FRACTION]
    width = 2.0 * math.pi / flow.cells.shape[0]
    y, rate = position[Y], position[RATE_OF_Y]
    if u > 0.0:
        y, rate = state_at_cell_start(flow, k, u, y, rate)
    for i in range(TERMS):
        c[i] = flow.cells[k, PARTICULAR, i] + y * flow.cells[k, OFFSET, i] + rate * flow.cells[k, RATE, i]
    if u > 0.0:
        move_origin(c, u)
    c[0] = position[Y]
    c[1] = position[RATE_OF_Y] * width
    return 1.0


@kernel
def state_at_cell_start(flow: Flow, k: int, u: float, y: float, rate: float) -> tuple[float, float]:
    """y and y' at the start of cell k of the flight that has y and rate at its fraction u."""
    width = 2.0 * math.pi / flow.cells.shape[0]
    zero, zero_rate = value_and_slope(flow.cells[k, PARTICULAR], u)
    one, one_rate = value_and_slope(flow.cells[k, OFFSET], u)
    two, two_rate = value_and_slope(flow.cells[k, RATE], u)
    y -= zero
    rate = rate * width - zero_rate
    determinant = one * two_rate - two * one_rate
    return (y * two_rate - rate * two) / determinant, (rate * one - y * one_rate) / determinant


@kernel
def clears(flow: Flow, walls: Walls, k: int, y: float, rate: float) -> bool:
    """True if a flight from the start of cell k certainly reaches no wall in it.

    Bounds y'' = r + q y + d y' while y is between the walls.
    """
    width = 2.0 * math.pi / flow.cells.shape[0]
    low, high = flow.bounds[k, 0], flow.bounds[k, 1]
    restoring = flow.bounds[k, 2] * max(walls.upper, walls.lower)
    damping = flow.bounds[k, 3]
    if damping * width >= 1.0:
        return False
    fastest = (abs(rate) + width * (max(-low, high) + restoring)) / (1.0 - damping * width)
    spread = restoring + damping * fastest
    up = y + max(0.0, width * (rate + 0.5 * width * max(0.0, high + spread)))
    down = y + min(0.0, width * (rate + 0.5 * width * min(0.0, low - spread)))
    return up < walls.upper and -walls.lower < down


@kernel
def skip(flow: Flow, walls: Walls, position: Any) -> bool:
    """Cross a whole cell that the flight certainly clears."""
    k, y, rate = int(position[CELL]), position[Y], position[RATE_OF_Y]
    if not clears(flow, walls, k, y, rate):
        return False
    ends = flow.ends[k]
    position[CELL] = k + 1.0
    position[Y] = ends[PARTICULAR, 0] + y * ends[OFFSET, 0] + rate * ends[RATE, 0]
    position[RATE_OF_Y] = ends[PARTICULAR, 1] + y * ends[OFFSET, 1] + rate * ends[RATE, 1]
    return True


@kernel
def carry_to(flow: Flow, k: int, u: float, v: Any) -> None:
    """Tangent vectors from the start of cell k to its fraction u."""
    width = 2.0 * math.pi / flow.cells.shape[0]
    one, one_slope = value_and_slope(flow.cells[k, OFFSET], u)
    two, two_slope = value_and_slope(flow.cells[k, RATE], u)
    for row in range(2):
        first, second = v[row, 0], v[row, 1]
        v[row, 0] = one * first + two * second
        v[row, 1] = (one_slope * first + two_slope * second) / width


@kernel
def carry_back(flow: Flow, k: int, u: float, v: Any) -> None:
    """Tangent vectors from fraction u of cell k to its start."""
    width = 2.0 * math.pi / flow.cells.shape[0]
    one, one_slope = value_and_slope(flow.cells[k, OFFSET], u)
    two, two_slope = value_and_slope(flow.cells[k, RATE], u)
    determinant = one * two_slope - two * one_slope
    for row in range(2):
        first, second = v[row, 0], v[row, 1] * width
        v[row, 0] = (two_slope * first - two * second) / determinant
        v[row, 1] = (one * second - one_slope * first) / determinant


@kernel
def carry(flow: Flow, start: Any, end: Any, v: Any, scratch: Any) -> None:
    """Tangent vectors (rows of v) along a flight between two positions."""
    k = int(start[CELL])
    if start[FRACTION] > 0.0:
        carry_back(flow, k, start[FRACTION], v)
    while k < int(end[CELL]):
        ends = flow.ends[k]
        for row in range(2):
            first, second = v[row, 0], v[row, 1]
            v[row, 0] = ends[OFFSET, 0] * first + ends[RATE, 0] * second
            v[row, 1] = ends[OFFSET, 1] * first + ends[RATE, 1] * second
        k += 1
    if end[FRACTION] > 0.0:
        carry_to(flow, k, end[FRACTION], v)


@kernel
def kick(flow: Flow, walls: Walls, position: Any, side: float) -> float:
    """e A_before + A_after of an impact, A = y'': linear in y', which leaves (1 + e) A at rest."""
    return (1.0 + walls.restitution) * side * pressing_at(flow, position, side)
