"""Flights and tangent vectors of the nonlinear form at constant speed.

In sigma = theta + eta, eta = phi - psi the rod's angle, free flight is a damped pendulum,

    a sigma'' + lambda sigma' + k sin sigma = 0,    k = (1 + alpha/2) xi,    y = xi sin theta - sin eta,

solved by its power series from any position (the series of sine and cosine follow from sigma's).
"""

import math
from typing import Any, NamedTuple

from ...compile.kernel import kernel
from ..equations import Crank, Mechanism, coupling, inertia, rod_curvature, rod_slope
from ..nonlinear import free_moment
from .bouncing import CELL, FLIGHT, FRACTION, OWN, RATE_OF_Y, Walls, Y, phase
from .series import DEGREE, TERMS, value_and_slope

# Rows of scratch.
ANGLE, SINE, COSINE, CRANK_SINE, CRANK_COSINE, DEVIATION = OWN, OWN + 1, OWN + 2, OWN + 3, OWN + 4, OWN + 5
# Radians of sigma for which the series of its sine is good to rounding: 0.5^14 / 14! = 7e-16.
SWING = 0.5


class PendulumFlow(NamedTuple):
    """The nonlinear form; `pressing` as in `flow.Flow`."""

    xi: float
    mechanism: Mechanism
    pressing: Any


@kernel
def rod_state(theta: float, y: float, rate: float, xi: float) -> tuple[float, float]:
    """eta and eta' per radian from y and y'."""
    sine = xi * math.sin(theta) - y
    return math.asin(sine), (xi * math.cos(theta) - rate) / math.sqrt(1.0 - sine * sine)


@kernel
def swing(theta: float, eta: float, eta_rate: float, flow: PendulumFlow, scratch: Any) -> float:
    """Series of sigma, its sine and its cosine; returns how much of a cell they are good for."""
    m = flow.mechanism
    width = 2.0 * math.pi / flow.pressing.shape[0]
    angle, sine, cosine = scratch[ANGLE], scratch[SINE], scratch[COSINE]
    angle[0] = theta + eta
    angle[1] = (1.0 + eta_rate) * width
    sine[0], cosine[0] = math.sin(angle[0]), math.cos(angle[0])
    friction, weight = m.damping / inertia(m) * width, coupling(m) / inertia(m) * width * width
    for i in range(DEGREE):
        rise = fall = 0.0
        for j in range(i + 1):
            slope = (j + 1.0) * angle[j + 1]
            rise += slope * cosine[i - j]
            fall += slope * sine[i - j]
        sine[i + 1] = rise / (i + 1.0)
        cosine[i + 1] = -fall / (i + 1.0)
        if i + 2 < TERMS:
            angle[i + 2] = -(friction * (i + 1.0) * angle[i + 1] + weight * sine[i]) / ((i + 1.0) * (i + 2.0))
    return SWING / abs(angle[1]) if abs(angle[1]) > SWING else 1.0


@kernel
def turn(theta: float, width: float, scratch: Any) -> None:
    """Series of sin theta and cos theta."""
    sine, cosine = scratch[CRANK_SINE], scratch[CRANK_COSINE]
    even, odd = math.sin(theta), math.cos(theta)
    factor = 1.0
    for i in range(TERMS):
        sine[i] = factor * even
        cosine[i] = factor * odd
        even, odd = odd, -even
        factor *= width / (i + 1.0)


@kernel
def flight(flow: PendulumFlow, position: Any, scratch: Any) -> float:
    """Series of y from the position on, in scratch[FLIGHT]; returns how much of a cell it is good for."""
    width = 2.0 * math.pi / flow.pressing.shape[0]
    theta = phase(flow, position)
    eta, eta_rate = rod_state(theta, position[Y], position[RATE_OF_Y], flow.xi)
    good = swing(theta, eta, eta_rate, flow, scratch)
    turn(theta, width, scratch)
    c = scratch[FLIGHT]
    for i in range(TERMS):
        total = flow.xi * scratch[CRANK_SINE, i]
        for j in range(i + 1):
            total -= scratch[SINE, j] * scratch[CRANK_COSINE, i - j]
            total += scratch[COSINE, j] * scratch[CRANK_SINE, i - j]
        c[i] = total
    c[0] = position[Y]
    c[1] = position[RATE_OF_Y] * width
    return good


@kernel
def skip(flow: PendulumFlow, walls: Walls, position: Any) -> bool:
    """Every cell has its own flight."""
    return False


@kernel
def deviate(
    flow: PendulumFlow, first: float, second: float, length: float, scratch: Any
) -> tuple[float, float]:
    """A deviation of sigma and its derivative after `length` of a cell along the last `swing`."""
    m = flow.mechanism
    width = 2.0 * math.pi / flow.pressing.shape[0]
    friction, weight = m.damping / inertia(m) * width, coupling(m) / inertia(m) * width * width
    d = scratch[DEVIATION]
    d[0], d[1] = first, second * width
    for i in range(DEGREE - 1):
        restoring = 0.0
        for j in range(i + 1):
            restoring += scratch[COSINE, j] * d[i - j]
        d[i + 2] = -(friction * (i + 1.0) * d[i + 1] + weight * restoring) / ((i + 1.0) * (i + 2.0))
    end, slope = value_and_slope(d, length)
    return end, slope / width


@kernel
def carry(flow: PendulumFlow, start: Any, end: Any, v: Any, scratch: Any) -> None:
    """Tangent vectors (rows of v) along a flight between two positions."""
    width = 2.0 * math.pi / flow.pressing.shape[0]
    k, u = int(start[CELL]), start[FRACTION]
    theta = (k + u) * width
    eta, eta_rate = rod_state(theta, start[Y], start[RATE_OF_Y], flow.xi)
    for row in range(2):
        v[row, 0] = -v[row, 0] / math.cos(eta)
        v[row, 1] = (math.sin(eta) * eta_rate * v[row, 0] - v[row, 1]) / math.cos(eta)
    while True:
        stop = end[FRACTION] if k == int(end[CELL]) else 1.0
        length = min(swing(theta, eta, eta_rate, flow, scratch), stop - u)
        for row in range(2):
            v[row, 0], v[row, 1] = deviate(flow, v[row, 0], v[row, 1], length, scratch)
        sigma, sigma_rate = value_and_slope(scratch[ANGLE], length)
        theta += length * width
        eta, eta_rate = sigma - theta, sigma_rate / width - 1.0
        if length < stop - u:
            u += length
            continue
        if k == int(end[CELL]) or (k + 1 == int(end[CELL]) and end[FRACTION] == 0.0):
            break
        k += 1
        u = 0.0
    for row in range(2):
        deviation = v[row, 0]
        v[row, 0] = -math.cos(eta) * deviation
        v[row, 1] = math.sin(eta) * eta_rate * deviation - math.cos(eta) * v[row, 1]


@kernel
def offset_acceleration(theta: float, y: float, rate: float, m: Mechanism) -> float:
    """y'' in free flight, per radian squared."""
    eta, eta_rate = rod_state(theta, y, rate, m.xi)
    psi = math.asin(m.xi * math.sin(theta)) - eta
    psi_rate = rod_slope(theta, m.xi) - eta_rate
    bend = rod_curvature(theta, m.xi) - free_moment(Crank(theta, 1.0, 0.0), psi, psi_rate, m) / inertia(m)
    return -m.xi * math.sin(theta) + math.sin(eta) * eta_rate**2 - math.cos(eta) * bend


@kernel
def kick(flow: PendulumFlow, walls: Walls, position: Any, side: float) -> float:
    """e A_before + A_after of an impact, A = y''."""
    theta, y, rate, e = phase(flow, position), position[Y], position[RATE_OF_Y], walls.restitution
    before = offset_acceleration(theta, y, rate, flow.mechanism)
    return e * before + offset_acceleration(theta, y, -e * rate, flow.mechanism)
