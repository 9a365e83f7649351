"""State at a position of an exact flight, and samples of the flight between two events."""

import math
from typing import Any, NamedTuple

import numpy as np

from ..compile.kernel import kernel, record_of
from ..core.component import Component
from ..core.integrator import copy, taylor
from .flight.bouncing import CELL, FRACTION, FREE, RATE_OF_Y, Walls, Y
from .forms import offset_slope, wall_angle, wall_rate
from .records import mechanism

# Panels of Gauss's rule: 8 points of 0.4 rad leave 1e-16 of a sliding force's integral.
PANEL = 0.4
NODES, WEIGHTS = (tuple(float(v) for v in values) for values in np.polynomial.legendre.leggauss(8))


def make_write_state(component: Component) -> Any:
    """write_state(position, x, u, p): write psi and psi' at the position into the state x."""
    P = component.parameters.dtype
    psi_at, rate_at = (component.state.index(name) for name in ("psi", "psi_rate"))
    angle_at, speed_at = component.inputs.index("crank_angle"), component.inputs.index("crank_speed")

    @kernel
    def write_state(position: Any, x: Any, u: Any, p: Any) -> None:
        parameters = record_of(p, P)
        theta, speed, m = u[angle_at], u[speed_at], mechanism(parameters)
        psi = wall_angle(parameters.form, theta, position[Y], m)
        slope = offset_slope(parameters.form, theta, psi, m)
        x[psi_at] = psi
        x[rate_at] = wall_rate(parameters.form, theta, speed, psi, m) + position[RATE_OF_Y] * speed / slope

    return write_state


class FlightCall(NamedTuple):
    """Arguments of one call of `advance`, its flow and its scratch vectors."""

    t: float  # at the start of the step
    x: Any  # state, with the mode between two events
    U: Any  # polynomials of the inputs
    p: Any  # parameters
    flow: Any
    walls: Walls
    scratch: Any  # of the flow's series
    u: Any  # inputs at an instant
    dx: Any  # derivative of the state
    xd: Any  # state at an instant
    work: Any  # the whole scratch vector


@kernel
def _sample_nothing(start: float, end: float, w: FlightCall, position: Any) -> None:
    return


def make_sample_flight(component: Component, next_event: Any, cells: int) -> Any:
    """sample_flight(start, end, w, position): sample the motion between two events of a step.

    Components with a `sample` kernel ask for this (see `models.core.quadrature`). `position` is that at the
    start; the kernel changes it, w.xd and w.u.
    """
    if component.sample is None:
        return _sample_nothing
    sample, write_state = component.sample, make_write_state(component)
    mode_at, speed_at = component.state.index("mode"), component.inputs.index("crank_speed")

    @kernel
    def sample_flight(start: float, end: float, w: FlightCall, position: Any) -> None:
        speed = w.U[0, speed_at]
        place = position[CELL] + position[FRACTION]
        panels = int((end - start) * speed / PANEL) + 1
        half = 0.5 * (end - start) / panels
        copy(w.xd, w.x)
        for panel in range(panels):
            for node in range(len(NODES)):
                s = start + half * (2.0 * panel + 1.0 + NODES[node])
                if w.x[mode_at] == FREE:
                    at = place + (s - start) * speed * cells / (2.0 * math.pi)
                    next_event(w.flow, w.walls, position, int(at), at - int(at), w.scratch)
                    taylor(w.U, s, w.u)
                    write_state(position, w.xd, w.u, w.p)
                sample(half * WEIGHTS[node], w.t, s, w.xd, w.U, w.u, w.p, w.work)

    return sample_flight
