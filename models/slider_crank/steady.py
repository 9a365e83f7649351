"""The component's advance at constant crank speed: exact flights instead of integration.

A step in which the crank turns uniformly, without films on the walls, is computed by `bouncing`, on a flow
that is tabulated once for the parameters and the speed. All other steps use the hybrid integrator. The table
is in the scratch vector and follows from the parameters: results depend on the state alone.
"""

import math
from typing import Any, NamedTuple

from ..compile.kernel import borrow, kernel, record_of, shaped
from ..core.component import Component
from ..core.hybrid import MOST_EVENTS, make_hybrid_advance
from ..core.integrator import OK, TOO_MANY_EVENTS, copy, taylor
from .equations import Mechanism
from .flight import linear, pendulum
from .flight.bouncing import (
    CELL,
    END,
    FRACTION,
    FREE,
    LOWER,
    POSITION_SIZE,
    RATE_OF_Y,
    RELEASE,
    SCRATCH_ROWS,
    SIDE,
    UPPER,
    UPPER_IMPACT,
    Walls,
    Y,
    make_next_event,
)
from .flight.flow import COLUMNS, FEWEST_CELLS, UNRESOLVED, Flow, tabulate
from .flight.samples import sample_flow, sample_pressing
from .flight.series import TERMS
from .forms import NONLINEAR, offset, offset_slope, wall_rate
from .records import WALL_FILMS, mechanism
from .sample_flight import NODES, PANEL, WEIGHTS, FlightCall, make_sample_flight, make_write_state

# With so many cells r = 0.4 l is resolved (`flow.tabulate_flow` doubles them; here the room is fixed).
CELLS = FEWEST_CELLS
# Radians by which a crank may depart from uniform turning within a step: the rounding of its angle.
UNIFORM = 1e-13
# Where the parts of the extra scratch end.
_CELLS = 3 * CELLS * TERMS
_ENDS = _CELLS + 6 * CELLS
_BOUNDS = _ENDS + 4 * CELLS
_PRESSING = _BOUNDS + 2 * CELLS * TERMS
_SAMPLES = _PRESSING + CELLS * COLUMNS
_MODES = _SAMPLES + CELLS * COLUMNS
_SERIES = _MODES + COLUMNS * TERMS
_SCRATCH = _SERIES + SCRATCH_ROWS * TERMS
_POSITION = _SCRATCH + POSITION_SIZE
EXTRA_WORK = _POSITION + 8


class AnyFlow(NamedTuple):
    """A flow of any form: the fields of `flow.Flow` and of `pendulum.PendulumFlow`."""

    form: float
    mechanism: Mechanism
    xi: float
    cells: Any
    ends: Any
    bounds: Any
    pressing: Any


@kernel
def dispatch_flight(flow: Any, position: Any, scratch: Any) -> float:
    """`flight` of the flow's form."""
    if flow.form == NONLINEAR:
        return pendulum.flight(flow, position, scratch)
    return linear.flight(flow, position, scratch)


@kernel
def dispatch_skip(flow: Any, walls: Walls, position: Any) -> bool:
    """`skip` of the flow's form."""
    return flow.form != NONLINEAR and linear.skip(flow, walls, position)


# The form is chosen flight by flight, so that one compiled component serves all forms.
next_event = make_next_event(dispatch_flight, dispatch_skip)


@kernel
def split_scratch(xi: float, extra: Any) -> Any:
    """Flow, position, scratch, key, and room for `flow.tabulate`, in the extra scratch."""
    flow = Flow(
        xi,
        shaped(extra[:_CELLS], (CELLS, 3, TERMS)),
        shaped(extra[_CELLS:_ENDS], (CELLS, 3, 2)),
        shaped(extra[_ENDS:_BOUNDS], (CELLS, 4)),
        shaped(extra[_BOUNDS:_PRESSING], (CELLS, 2, TERMS)),
    )
    room = (
        shaped(extra[_PRESSING:_SAMPLES], (CELLS, COLUMNS)),
        shaped(extra[_SAMPLES:_MODES], (CELLS // 2, COLUMNS, 2)),
        shaped(extra[_MODES:_SERIES], (COLUMNS, TERMS)),
    )
    scratch = shaped(extra[_SERIES:_SCRATCH], (SCRATCH_ROWS, TERMS))
    return flow, extra[_SCRATCH:_POSITION], scratch, extra[_POSITION:], room


@kernel
def tabulate_for(form: float, m: Mechanism, gap: float, flow: Flow, key: Any, room: Any) -> bool:
    """Fill `flow` for a mechanism at unit speed, if it is not there already; False if it is unresolved.

    room: samples, modes and series for `flow.tabulate`. key: form, mechanism and gap of the table.
    """
    known = key[7] != 0.0 and key[0] == form and key[6] == gap
    known = known and key[1] == m.xi and key[2] == m.alpha and key[3] == m.beta
    if not (known and key[4] == m.forcing_beta and key[5] == m.damping):
        samples, modes, series = room
        samples[:, :] = 0.0
        if form != NONLINEAR:
            sample_flow(m, samples)
        sample_pressing(form, m, gap, samples)
        resolved = tabulate(samples, flow, modes, series) <= UNRESOLVED
        key[0], key[1], key[2], key[3] = form, m.xi, m.alpha, m.beta
        key[4], key[5], key[6] = m.forcing_beta, m.damping, gap
        key[7] = 1.0 if resolved else -1.0
    return key[7] > 0.0


def make_integrate_forces(component: Component) -> Any:
    """integrate_forces(start, end, w): add the time integrals of the wall forces to the state.

    A release is found PAST_ZERO after the force's zero; the small negative force until then is left out.
    """
    derivative = component.flat_derivative
    upper_at, lower_at = (component.state.index(f"{side}_force_integral") for side in ("upper", "lower"))
    speed_at = component.inputs.index("crank_speed")

    @kernel
    def integrate_forces(start: float, end: float, w: FlightCall) -> None:
        panels = int((end - start) * w.U[0, speed_at] / PANEL) + 1
        half = 0.5 * (end - start) / panels
        for panel in range(panels):
            for node in range(len(NODES)):
                s = start + half * (2.0 * panel + 1.0 + NODES[node])
                taylor(w.U, s, w.u)
                derivative(w.t + s, w.x, w.u, w.p, w.dx)
                w.x[upper_at] += half * WEIGHTS[node] * max(0.0, w.dx[upper_at])
                w.x[lower_at] += half * WEIGHTS[node] * max(0.0, w.dx[lower_at])

    return integrate_forces


def make_fly(component: Component) -> Any:
    """fly(h, w, position, before) -> status: exact motion over h; `before` is room for a position."""
    write_state, sample_flight = make_write_state(component), make_sample_flight(component, next_event, CELLS)
    integrate_forces, transition = make_integrate_forces(component), component.flat_transition
    mode_at, speed_at = component.state.index("mode"), component.inputs.index("crank_speed")
    width = 2.0 * math.pi / CELLS

    @kernel
    def fly(h: float, w: FlightCall, position: Any, before: Any) -> int:
        x, u = w.x, w.u
        speed = w.U[0, speed_at]
        first = position[CELL] + position[FRACTION]
        last = first + speed * h / width
        turned, elapsed, events = 0, 0.0, 0
        while True:
            left = last - turned * CELLS
            whole = left >= CELLS
            k = CELLS - 1 if whole else int(left)
            started = elapsed
            copy(before, position)
            code = next_event(w.flow, w.walls, position, k, 1.0 if whole else left - k, w.scratch)
            elapsed = (position[CELL] + position[FRACTION] + turned * CELLS - first) * width / speed
            if code == END and not whole:
                elapsed = h
            if x[mode_at] != FREE:
                integrate_forces(started, elapsed, w)
            sample_flight(started, elapsed, w, before)
            taylor(w.U, elapsed, u)
            if code != END:
                write_state(position, x, u, w.p)
                transition(code - UPPER_IMPACT, w.t + elapsed, x, u, w.p)
                settle(w.walls, position, code, x[mode_at])
                events += 1
                if events > MOST_EVENTS:
                    return TOO_MANY_EVENTS
            elif whole:
                position[CELL] = position[FRACTION] = 0.0
                turned += 1
            else:
                write_state(position, x, u, w.p)
                return OK

    return fly


@kernel
def settle(walls: Walls, position: Any, code: int, mode: float) -> None:
    """Give the position the mode that the component's transition has chosen, and y' after the event."""
    if code == RELEASE:
        return
    side = UPPER if code == UPPER_IMPACT else LOWER
    position[SIDE] = mode
    position[Y] = walls.upper if side == UPPER else -walls.lower
    rebound = walls.restitution * max(0.0, side * position[RATE_OF_Y])
    position[RATE_OF_Y] = -side * rebound if mode == FREE else 0.0


def make_is_uniform(component: Component) -> Any:
    """is_uniform(h, x, U): whether the crank turns forward at constant speed and no film is on the walls."""
    names = component.inputs.names
    angle_at, speed_at = names.index("crank_angle"), names.index("crank_speed")
    films_at = tuple(component.state.index(name) for name in WALL_FILMS)

    @kernel
    def is_uniform(h: float, x: Any, U: Any) -> bool:
        for i in films_at:
            if x[i] != 0.0:
                return False
        speed = U[0, speed_at]
        departure = h * abs(U[1, angle_at] - speed)
        departure += h * h * (0.5 * abs(U[2, angle_at]) + h * abs(U[3, angle_at]) / 6.0)
        departure += h * h * (abs(U[1, speed_at]) + h * (abs(U[2, speed_at]) + h * abs(U[3, speed_at])))
        if not speed > 0.0 or departure > UNIFORM:
            return False
        for i in range(U.shape[1]):
            if i not in (angle_at, speed_at):
                for k in range(U.shape[0]):
                    if U[k, i] != 0.0:
                        return False
        return True

    return is_uniform


def make_read_position(component: Component) -> Any:
    """read_position(x, U, p, gap, position): set the position from state and inputs at the start."""
    P = component.parameters.dtype
    angle_at, speed_at = component.inputs.index("crank_angle"), component.inputs.index("crank_speed")
    psi_at, rate_at, mode_at = (component.state.index(name) for name in ("psi", "psi_rate", "mode"))

    @kernel
    def read_position(x: Any, U: Any, p: Any, gap: float, position: Any) -> None:
        parameters = record_of(p, P)
        theta, speed, m = U[0, angle_at], U[0, speed_at], mechanism(parameters)
        place = (theta / (2.0 * math.pi) - math.floor(theta / (2.0 * math.pi))) * CELLS
        position[CELL] = min(int(place), CELLS - 1)
        position[FRACTION] = place - position[CELL]
        position[SIDE] = x[mode_at]
        position[Y] = x[mode_at] * gap
        position[RATE_OF_Y] = 0.0
        if x[mode_at] == FREE:
            psi = x[psi_at]
            off_wall = x[rate_at] - wall_rate(parameters.form, theta, speed, psi, m)
            position[Y] = min(max(offset(parameters.form, theta, psi, m), -gap), gap)
            position[RATE_OF_Y] = offset_slope(parameters.form, theta, psi, m) * off_wall / speed

    return read_position


def make_advance(component: Component) -> Any:
    """advance(t, h, x, U, p, scale, work) -> status, as `integrator.make_advance`."""
    hybrid = make_hybrid_advance(component.motion)
    fly, read_position, is_uniform = (
        make_fly(component),
        make_read_position(component),
        make_is_uniform(component),
    )
    base, n, m = component.standard_work_size, component.state.size, component.inputs.size
    P, speed_at = component.parameters.dtype, component.inputs.index("crank_speed")

    @kernel
    def advance(t: float, h: float, x: Any, U: Any, p: Any, scale: Any, work: Any) -> int:
        if not is_uniform(h, x, U):
            return hybrid(t, h, x, U, p, scale, work)
        parameters = record_of(p, P)
        form, c = parameters.form, mechanism(parameters)
        c = Mechanism(c.xi, c.alpha, c.beta, c.forcing_beta, c.damping / U[0, speed_at])
        gap = parameters.clearance / parameters.rod_length
        room = borrow(work)
        table, position, scratch, key, samples = split_scratch(c.xi, room[base:])
        if not tabulate_for(form, c, gap, table, key, samples):
            return hybrid(t, h, x, U, p, scale, work)
        flow = AnyFlow(form, c, c.xi, table.cells, table.ends, table.bounds, table.pressing)
        walls = Walls(gap, gap, parameters.restitution, 0.0)
        start, u, dx, xd = room[:n], room[n : n + m], room[n + m : 2 * n + m], room[2 * n + m : 3 * n + m]
        before = room[3 * n + m : 3 * n + m + POSITION_SIZE]
        w = FlightCall(t, borrow(x), borrow(U), borrow(p), flow, walls, scratch, u, dx, xd, room)
        read_position(x, U, p, gap, position)
        copy(start, x)
        status = fly(h, w, position, before)
        if status != OK:
            copy(x, start)
        return status

    return advance
