"""Integrate a problem through its events to requested instants, by any method."""

from collections.abc import Callable
from typing import Protocol

import numpy as np

from ..core.quantities import Vector
from ..core.system import ModelError
from .problem import TIME_EVENT, Event, Problem

# Events at one instant, or so close together that time stands still, after which a problem is given up.
STALLED_EVENTS = 1000
# What has fallen where an event was known in advance.
TIME_EVENTS: tuple[int, ...] = (TIME_EVENT,)
# Events are "at one instant" when nearer than this share of the largest time: some thousand roundings,
# ten times what CVODE's shortest step needs.
INSTANT = 1e-12


class Method(Protocol):
    """An integrator: `begin` at a state, then `to` any number of targets."""

    name: str

    def begin(self, t: float, z: Vector, end: float) -> None:
        """Start at (t, z); no target will lie behind `end`."""

    def to(self, target: float) -> tuple[float, Vector, tuple[int, ...]]:
        """(t, z, fallen guards): at the target, or at the first event before it. ModelError on failure."""


def march(
    problem: Problem,
    method: Method,
    z0: Vector,
    t0: float,
    times: Vector,
    progress: Callable[[float], None] | None = None,
    sample: Callable[[float, Vector], Vector] | None = None,
) -> tuple[Vector, list[Event]]:
    """States at `times`, (n, size), and the events on the way. At an event's own instant: after it.

    With `sample`(t, z) its results stand in the place of the states.
    """
    end = float(times[-1])
    events: list[Event] = []
    rows = []
    t, z = t0, z0.copy()
    _settle(problem, t, z, (), events)
    begun, stalled, longest = False, 0, max(abs(t0), abs(end))
    for i, target in enumerate(times):
        while t < target or t >= problem.next_event:
            if t >= problem.next_event:
                reached, fallen = t, TIME_EVENTS
            else:
                if not begun:
                    method.begin(t, z, min(end, problem.next_event))
                    begun = True
                reached, z, fallen = method.to(min(float(target), problem.next_event))
            if fallen:
                stalled = stalled + 1 if reached - t <= INSTANT * longest else 0
                _settle(problem, reached, z, fallen, events)
                if stalled > STALLED_EVENTS:
                    raise _too_many(events[-1])
                begun = False
            t = reached
        rows.append(z.copy() if sample is None else sample(t, z))
        if progress is not None:
            progress((i + 1) / times.size)
    return np.array(rows), events


def _settle(problem: Problem, t: float, z: Vector, fallen: tuple[int, ...], events: list[Event]) -> None:
    """Make the transitions of the guards in `fallen`, then of all that are negative after them.

    A guard that fell at the same instant as another makes its transition unless the other's has lifted it.
    """
    if problem.guard_count == 0 and not fallen:
        return
    before = problem.guards(t, z).copy()
    for n, guard in enumerate(fallen):
        if n == 0 or problem.guards(t, z)[guard] <= max(before[guard], 0.0):
            events.append(problem.transition(guard, t, z))
    for _ in range(STALLED_EVENTS):
        negative = np.flatnonzero(problem.guards(t, z) < 0.0)
        if negative.size == 0:
            return
        events.append(problem.transition(int(negative[0]), t, z))
    raise _too_many(events[-1])


def _too_many(last: Event) -> ModelError:
    return ModelError(
        f"{last.instance}: more than {STALLED_EVENTS} events at t = {last.time:.9g} s, the last of guard "
        f"{last.guard}; its transition must lift the guard, and chatter must end (sliding, plastic impact)"
    )
