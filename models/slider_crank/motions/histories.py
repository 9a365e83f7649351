"""Records of bouncing motions: events, states at chosen phases, growth of tangent vectors.

`LINEAR` and `NONLINEAR` hold the same kernels for the two kinds of flight. All of them take a flow, walls,
a position that they advance, and scratch (SCRATCH_ROWS, TERMS).

Tangent vectors (dy, dy') are the rows of `v`. An impact maps them by its saltation matrix (phase fixed):

    dy -> -e dy,    dy' -> -e dy' + (e A_before + A_after) dy / y'_before,

A the acceleration y'' just before and after it; determinant e^2. Hence the exponents' exact sum
-lambda/a + 2 N ln e/(2 pi) for N impacts a cycle. At the onset of sliding every deviation ends, and none
begins at the release, whose phase does not depend on the past: both vectors become zero, and the
exponents are -infinity.
"""

import math
from typing import Any, NamedTuple

from ...compile.kernel import kernel
from ...core.integrator import copy
from ..flight import linear as linear_flight
from ..flight import pendulum as pendulum_flight
from ..flight.bouncing import (
    CELL,
    END,
    FRACTION,
    FREE,
    LOWER,
    RATE_OF_Y,
    RELEASE,
    SIDE,
    UPPER,
    UPPER_IMPACT,
    Walls,
    Y,
    make_next_event,
    pass_event,
    phase,
    strike,
)

# Columns of an event: revolution, phase in it, side, y' before it, and what it was.
CYCLE, PHASE, EVENT_SIDE, RATE_BEFORE, KIND, EVENT_SIZE = 0, 1, 2, 3, 4, 5
BOUNCE, ONSET, LIFT = 0.0, 1.0, 2.0
# A state: y, y' and the side on which it slides.
STATE_SIZE = 3


class Histories(NamedTuple):
    """The kernels for one kind of flight; see `make_histories`."""

    next_event: Any
    record_events: Any
    strobe: Any
    sample: Any
    follow_tangents: Any


@kernel
def begin_cycle(position: Any) -> None:
    """Put the phase back to zero at the end of a revolution."""
    position[CELL] = 0.0
    position[FRACTION] = 0.0


@kernel
def copy_state(position: Any, state: Any) -> None:
    state[0], state[1], state[2] = position[Y], position[RATE_OF_Y], position[SIDE]


@kernel
def apply_saltation(restitution: float, kick: float, rate: float, v: Any) -> None:
    """The saltation matrix; `kick` is e A_before + A_after, `rate` y' before the impact."""
    for row in range(2):
        v[row, 1] = -restitution * v[row, 1] + kick / rate * v[row, 0]
        v[row, 0] = -restitution * v[row, 0]


@kernel
def orthonormalize(v: Any, growth: Any) -> None:
    """Gram and Schmidt; adds the logarithms of the lengths to growth. Zero vectors stay zero."""
    growth[0] += normalize(v[0])
    along = v[0, 0] * v[1, 0] + v[0, 1] * v[1, 1]
    v[1, 0] -= along * v[0, 0]
    v[1, 1] -= along * v[0, 1]
    growth[1] += normalize(v[1])


@kernel
def normalize(v: Any) -> float:
    """Divide a vector by its length; returns the logarithm of that."""
    length = math.hypot(v[0], v[1])
    if length == 0.0:
        return -math.inf
    v[0] /= length
    v[1] /= length
    return math.log(length)


def make_follow_tangents(next_event: Any, carry: Any, kick: Any) -> Any:
    """follow_tangents(flow, walls, position, v, cycles, growth, scratch) -> number of impacts.

    Adds the logarithmic growth of two tangent vectors v over revolutions; growth[2:] (POSITION_SIZE elements)
    is scratch. `carry` takes v from one position to another, impacts have that `kick`.
    """

    @kernel
    def follow_tangents(
        flow: Any, walls: Walls, position: Any, v: Any, cycles: int, growth: Any, scratch: Any
    ) -> int:
        last = flow.pressing.shape[0] - 1
        start = growth[2:]
        impacts = 0
        for _ in range(cycles):
            code = -1
            while code != END:
                copy(start, position)
                code = next_event(flow, walls, position, last, 1.0, scratch)
                if start[SIDE] == FREE:
                    carry(flow, start, position, v, scratch)
                else:
                    v[0, 0] = v[0, 1] = v[1, 0] = v[1, 1] = 0.0
                if code in (END, RELEASE):
                    continue
                side = UPPER if code == UPPER_IMPACT else LOWER
                rate = position[RATE_OF_Y]
                jerk = kick(flow, walls, position, side)
                strike(flow, walls, position, side)
                impacts += 1
                if position[SIDE] != FREE:
                    v[0, 0] = v[0, 1] = v[1, 0] = v[1, 1] = 0.0
                elif rate != 0.0:
                    apply_saltation(walls.restitution, jerk, rate, v)
            begin_cycle(position)
            orthonormalize(v, growth)
        return impacts

    return follow_tangents


def make_histories(flight: Any, skip: Any, carry: Any, kick: Any) -> Histories:
    """The kernels for flights given by `flight` and `skip` (see `bouncing.make_next_event`), whose tangent
    vectors `carry` takes from one position to another and whose impacts have that `kick`."""
    next_event = make_next_event(flight, skip)

    @kernel
    def record_events(
        flow: Any, walls: Walls, position: Any, cycle: int, cycles: int, events: Any, scratch: Any
    ) -> tuple[int, int]:
        """Run until `cycles` revolutions are complete or the table of events (., EVENT_SIZE) is full.

        Returns the revolution reached and the number of events.
        """
        last = flow.pressing.shape[0] - 1
        count = 0
        while cycle < cycles and count < events.shape[0]:
            code = next_event(flow, walls, position, last, 1.0, scratch)
            if code == END:
                begin_cycle(position)
                cycle += 1
                continue
            row = events[count]
            row[CYCLE] = cycle
            row[PHASE] = phase(flow, position)
            row[RATE_BEFORE] = position[RATE_OF_Y]
            row[EVENT_SIDE] = pass_event(flow, walls, position, code)
            row[KIND] = LIFT if code == RELEASE else BOUNCE if position[SIDE] == FREE else ONSET
            count += 1
        return cycle, count

    @kernel
    def reach(flow: Any, walls: Walls, position: Any, cell: int, fraction: float, scratch: Any) -> int:
        """Advance to a phase; returns the number of impacts."""
        impacts = 0
        code = next_event(flow, walls, position, cell, fraction, scratch)
        while code != END:
            pass_event(flow, walls, position, code)
            impacts += code != RELEASE
            code = next_event(flow, walls, position, cell, fraction, scratch)
        return impacts

    @kernel
    def strobe(flow: Any, walls: Walls, position: Any, states: Any, scratch: Any) -> int:
        """States (., STATE_SIZE) at the end of every revolution; returns the number of impacts."""
        impacts = 0
        for cycle in range(states.shape[0]):
            impacts += reach(flow, walls, position, flow.pressing.shape[0] - 1, 1.0, scratch)
            begin_cycle(position)
            copy_state(position, states[cycle])
        return impacts

    @kernel
    def sample(flow: Any, walls: Walls, position: Any, phases: Any, states: Any, scratch: Any) -> None:
        """States (., STATE_SIZE) at increasing phases of this revolution; advances to its end."""
        cells = flow.pressing.shape[0]
        for i in range(phases.shape[0]):
            place = phases[i] * cells / (2.0 * math.pi)
            k = min(int(place), cells - 1)
            reach(flow, walls, position, k, place - k, scratch)
            copy_state(position, states[i])
        reach(flow, walls, position, cells - 1, 1.0, scratch)
        begin_cycle(position)

    follow_tangents = make_follow_tangents(next_event, carry, kick)
    return Histories(next_event, record_events, strobe, sample, follow_tangents)


LINEAR = make_histories(linear_flight.flight, linear_flight.skip, linear_flight.carry, linear_flight.kick)
NONLINEAR = make_histories(
    pendulum_flight.flight, pendulum_flight.skip, pendulum_flight.carry, pendulum_flight.kick
)
