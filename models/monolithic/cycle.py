"""Steady cycles: motions of a system that repeat themselves after a period."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..core.quantities import Vector
from ..core.system import ModelError, System
from .cvode import Cvode
from .march import march
from .problem import SystemProblem
from .reference import observe, stiffness

# Of the integrator, over nominal + |value|. What a period changes is found to a hundred times that.
TOLERANCE = 1e-8
STEADY = 1e-5
# Less than a sensor or a limit sees: figures of motions that a period changes by no more are used.
USABLE = 1e-3
MOST_PERIODS = 60
# The progress of a search is that of its least change in so many periods, after those in which it settles.
# Subharmonic and chaotic motions have no cycle of this period.
PATIENCE, SETTLING = 15, 5
# Periods that Anderson's method combines, and those that only settle before.
MEMORY, SETTLED = 6, 3
# Slopes of a period are differences over this of scaled states. Motions that take more than so many periods
# to settle are left as they are.
DIFFERENCE, SLOWEST = 1e-4, 1e3
# What is left of I - Phi where nothing ends a motion; of singular values as a share of the largest.
NEUTRAL = 1e-11

# States at the instants `stops`, from a state at the first of `times`, to a tolerance.
Move = Callable[[SystemProblem, Vector, Vector, Vector, float], Vector]


def move_by_cvode(
    problem: SystemProblem, x: Vector, times: Vector, stops: Vector, tolerance: float
) -> Vector:
    """States at `stops`, from `x` at the first; steps are no longer than the distances of `times`."""
    z = problem.start(x)
    stiff, longest = stiffness(problem, 0.0, z, times)
    method = Cvode(problem, tolerance, stiff, longest)
    return march(problem, method, z, 0.0, stops)[0] if problem.guard_count else method.along(z, stops)


@dataclass(frozen=True)
class Search:
    """What moves a problem through a period, and the scaled state from which to go on behind one from a state
    to another."""

    problem: SystemProblem
    move: Move = move_by_cvode
    lead: Callable[[Vector, Vector], Vector] = lambda begin, end: end


@dataclass(frozen=True)
class Cycle:
    """One period of a motion, sampled at equal distances, both ends included.

    `inputs`, `outputs` and `states` are (n, variables of the system), `end` is the last state. `change` is
    the largest change of a state over the period, relative to nominal + |value|. `periods` were computed.
    """

    system: System
    times: Vector
    inputs: Vector
    outputs: Vector
    end: Vector
    change: float
    periods: int
    states: Vector = field(default_factory=lambda: np.zeros((0, 0)))

    @property
    def steady(self) -> bool:
        return self.change <= STEADY

    def __getitem__(self, name: str) -> Vector:
        """The input or output called "instance.variable", (n,). KeyError for other names."""
        for layout, table in ((self.system.outputs, self.outputs), (self.system.inputs, self.inputs)):
            if name in layout.names:
                return np.asarray(table[:, layout.names.index(name)])
        raise KeyError(f"{name!r} is no input or output of the system")


def list_held(system: System, turning: Sequence[str]) -> NDArray[np.bool_]:
    """By state whether each period begins it at its start: those `turning`, and those that accumulate."""
    fields = [f for instance in system.instances.values() for f in instance.component.state.fields]
    names = zip(system.state.names, fields, strict=True)
    return np.array([name in turning or field.quantity.accumulates for name, field in names])


def find_cycle(
    system: System,
    period: float,
    turning: Sequence[str],
    start: Vector | None = None,
    samples: int = 720,
    most_periods: int = MOST_PERIODS,
    tolerance: float = TOLERANCE,
    steady: float = STEADY,
    search: Search | None = None,
) -> Cycle:
    """The cycle of that period (s), from the state `start` (default: the system's start).

    Each period begins at time 0 with the states `turning`, and those that accumulate, at their starts. All
    others go on from where the last period ended, extrapolated by Anderson's method; where that leads to a
    state from which nothing can move, from the end itself, until a period changes no state by more than
    `steady`. Where it does not settle in `most_periods`, or would not at its rate, the period of the least
    change is returned. `tolerance` is the integrator's, over nominal + |value|. A `search` for the same
    components and connections takes the system's values, so that nothing is compiled again. ModelError if a
    method fails.
    """
    search = search or Search(SystemProblem(system, counts_energies=False))
    problem = search.problem
    problem.take(system)
    times = np.linspace(0.0, period, samples + 1)
    n = system.state.size
    held = list_held(system, turning)
    scaling = _Scaling(system, held)
    x = np.array(system.x0 if start is None else start, dtype=np.float64)
    x[held] = system.x0[held]
    # Any period may be the last one, and its samples are free where no guard has to be located between them.
    stops = times[[0, -1]] if problem.guard_count else times
    begun, ended, found = list[Vector](), list[Vector](), list[_Period]()
    states = np.zeros((0, n))
    while len(found) < most_periods:
        try:
            rows = search.move(problem, x, times, stops, tolerance)
        except ModelError:
            if len(begun) < SETTLED:
                raise
            x = scaling.state(ended[-1], x)
            begun, ended = [], []
            continue
        end = rows[-1, :n]
        change = np.abs(end - x)[~held] / (system.state.nominal + np.abs(x))[~held]
        found.append(_Period(x, end.copy(), float(np.max(change, initial=0.0))))
        changes = [period.change for period in found]
        if changes[-1] == min(changes):
            states = rows
        if changes[-1] <= steady or is_hopeless(changes, most_periods, steady):
            break
        begun.append(scaling.flat(x))
        ended.append(search.lead(begun[-1], scaling.flat(end)))
        x = scaling.state(_extrapolate(begun[-MEMORY:], ended[-MEMORY:]), x)
    best = found[-1 - int(np.argmin(changes[::-1]))]
    if len(states) < times.size:
        states = search.move(problem, best.begin, times, times, tolerance)
    inputs, outputs = observe(problem.evaluation, times, states)
    return Cycle(system, times, inputs, outputs, best.end, best.change, len(found), states[:, :n])


def learn_slopes(
    search: Search, system: System, period: float, turning: Sequence[str], start: Vector, tolerance: float
) -> Search:
    """Newton's method from a steady cycle to those of near values. With the slopes Phi of its end by its
    `start`, a period that misses its start by r moves the start by (I - Phi)^-1 r. Arguments as of
    `find_cycle`. ModelError if a method fails."""
    search.problem.take(system)
    held, times = list_held(system, turning), np.array([0.0, period])
    scaling = _Scaling(system, held)
    x = np.where(held, system.x0, start)

    def find_end(scaled: Vector) -> Vector:
        rows = search.move(search.problem, scaling.state(scaled, x), times, times, tolerance)
        return scaling.flat(rows[-1, : x.size])

    begin = scaling.flat(x)
    moved = [find_end(begin + step) - find_end(begin - step) for step in DIFFERENCE * np.eye(begin.size)]
    opening = np.eye(begin.size) - np.array(moved).T / (2.0 * DIFFERENCE)
    closing = close_period(opening, np.eye(begin.size), 1.0 / SLOWEST)
    return replace(search, lead=partial(_close, closing))


def close_period(opening: Vector, right: Vector, neutral: float = NEUTRAL) -> Vector:
    """Changes of the start that close the cycle. States that nothing moves, as those of a rigid shaft, keep
    their start; of motions that nothing ends, what is not moved is the smallest. Of these rows of I - Phi and
    singular values are below `neutral`."""
    moves = np.any(np.abs(opening) > neutral, axis=1)
    found = np.zeros_like(right)
    found[moves] = np.linalg.lstsq(opening[np.ix_(moves, moves)], right[moves], rcond=neutral)[0]
    return found


def _close(closing: Vector, begin: Vector, end: Vector) -> Vector:
    return np.asarray(begin + closing @ (end - begin))


class _Period(NamedTuple):
    begin: Vector
    end: Vector
    change: float


def is_hopeless(changes: Sequence[float], most_periods: int = MOST_PERIODS, steady: float = STEADY) -> bool:
    """Whether PATIENCE periods did not halve the least change and at that rate `most_periods` are too few."""
    before, last = changes[SETTLING:-PATIENCE], changes[-PATIENCE:]
    if not before:
        return False
    ratio, wanted = min(last) / min(before), steady / min(last)
    left = (most_periods - len(changes)) / PATIENCE
    return ratio > 0.5 and ratio**left > wanted


class _Scaling:
    """States as numbers of size 1 that may take any value: positive ones by their logarithm."""

    def __init__(self, system: System, held: NDArray[np.bool_]) -> None:
        fields = [f for instance in system.instances.values() for f in instance.component.state.fields]
        self.free = ~held
        self.positive = np.array([f.quantity.positive for f in fields])[self.free]
        self.nominal = system.state.nominal[self.free]

    def flat(self, x: Vector) -> Vector:
        free = x[self.free]
        scaled: Vector = free / self.nominal
        scaled[self.positive] = np.log(scaled[self.positive])
        return scaled

    def state(self, scaled: Vector, before: Vector) -> Vector:
        values = scaled.copy()
        values[self.positive] = np.exp(values[self.positive])
        x = before.copy()
        x[self.free] = values * self.nominal
        return x


def _extrapolate(begun: Sequence[Vector], ended: Sequence[Vector]) -> Vector:
    """Anderson's method: the combination of the last periods whose change would be least.

    The first periods only settle; a combination that is larger than the last change is not believed.
    """
    change = ended[-1] - begun[-1]
    if len(begun) < SETTLED:
        return ended[-1]
    changes = np.array([e - b for b, e in zip(begun, ended, strict=True)])
    shares = np.linalg.lstsq(np.diff(changes, axis=0).T, change, rcond=1e-6)[0]
    step = shares @ np.diff(np.array(ended), axis=0)
    if not np.all(np.isfinite(step)) or np.linalg.norm(step) > 10.0 * np.linalg.norm(change):
        return ended[-1]
    return np.asarray(ended[-1] - step)
