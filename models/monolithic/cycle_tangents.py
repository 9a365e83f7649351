"""Derivatives of a steady cycle by parameters: its tangents, closed over the period.

With Phi and b the tangents of a period's end by its start and by a parameter, the start of the cycle changes
by s = Phi s + b. The same Phi leads from a cycle that is nearly closed to the closed one, by Newton's method.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial

import numpy as np
from threadpoolctl import threadpool_limits

from ..core.quantities import Vector
from ..core.system import ModelError, System
from .cycle import close_period, list_held
from .slopes import Slopes
from .variation import STATES, Flow, Progress, Variation

# A period changes no state by more than this of nominal + |value|; Newton's method is at rounding after few.
CLOSED, ITERATIONS = 1e-10, 6


@dataclass(frozen=True)
class Direction:
    """A change of parameters by "instance.parameter", and with it of the period (s)."""

    parameters: Mapping[str, float]
    period: float = 0.0


@dataclass(frozen=True)
class Rows:
    """Instants of a cycle (k,), with inputs and outputs (k, variables), and by how much all these change
    in each direction (directions, ...): an instant stays at its event, else at its share of the period, or at
    the angle of a shaft.
    """

    times: Vector
    inputs: Vector
    outputs: Vector
    times_by: Vector
    inputs_by: Vector
    outputs_by: Vector


@dataclass(frozen=True)
class CycleTangents:
    """`change` is the largest of a state over the period; `multipliers` are Floquet's, eigenvalues of Phi;
    `start` is by how much the first state changes (states, directions); `turning` is the state whose values
    instants keep, where there is one."""

    system: System
    period: float
    change: float
    multipliers: Vector
    directions: Sequence[Direction]
    start: Vector
    _slopes: Slopes = field(repr=False)
    _flow: Flow = field(repr=False)
    turning: int | None = None

    @property
    def begin(self) -> float:
        """Of the motion (s)."""
        return self._flow.steps[0].t

    @property
    def steps(self) -> int:
        return len(self._flow.steps)

    def values_at(self, times: Vector) -> tuple[Vector, Vector]:
        """Inputs and outputs at ascending instants."""
        e, found = self._slopes.evaluation, []
        for t, x in zip(times, self._states_at(times), strict=True):
            y = e.outputs(float(t), x).copy()
            found.append((e.u.copy(), y))
        return np.array([u for u, _ in found]), np.array([y for _, y in found])

    def event_times(self) -> Vector:
        """Instants just before and just behind every event."""
        return np.array([t for e in self._flow.events for t in (e.t - e.near, e.t + e.near)])

    def rows_at(self, times: Vector) -> Rows:
        """At ascending instants."""
        s, d, n = self.system, len(self.directions), self.system.state.size
        periods = np.array([one.period for one in self.directions]) / self.period
        later: dict[float, Vector] = {}
        for event in self._flow.events:
            shift = self.start.T @ event.later[:n] + event.later[n:]
            later |= {event.t - event.near: shift, event.t + event.near: shift}
        inputs, outputs = np.empty((times.size, s.inputs.size)), np.empty((times.size, s.outputs.size))
        times_by = np.empty((d, times.size))
        inputs_by, outputs_by = np.empty((d, *inputs.shape)), np.empty((d, *outputs.shape))
        states, steps = self._states_at(times), np.vstack([self._slopes.steps, np.zeros((1, s.p.size))])
        for i, tangents in enumerate(self._tangents_at(times)):
            t, x = float(times[i]), states[i]
            rate = self._slopes.rates(times[i : i + 1], x[None])
            moved = np.vstack([(tangents[:, :n] @ self.start + tangents[:, n:]).T, rate])
            _, by_input, by_output = self._slopes.along(t, x, np.ascontiguousarray(moved), steps)
            inputs[i], outputs[i] = self._slopes.evaluation.u, self._slopes.evaluation.y
            still = t * periods if self.turning is None else _keep(moved[:, self.turning])
            times_by[:, i] = later.get(t, still)
            inputs_by[:, i] = by_input[:d] + np.outer(times_by[:, i], by_input[d])
            outputs_by[:, i] = by_output[:d] + np.outer(times_by[:, i], by_output[d])
        return Rows(times, inputs, outputs, times_by, inputs_by, outputs_by)

    def _parts(self, times: Vector) -> list[tuple[int, Vector]]:
        """Steps and the instants in them."""
        starts = np.array([step.t for step in self._flow.steps])
        place = np.maximum(np.searchsorted(starts, times, side="right") - 1, 0)
        return [(int(k), times[place == k]) for k in np.unique(place)]

    def _states_at(self, times: Vector) -> Vector:
        return np.vstack([self._flow.steps[k].states_at(part) for k, part in self._parts(times)])

    def _tangents_at(self, times: Vector) -> Sequence[Vector]:
        parts = self._parts(times)
        return [tangents for k, part in parts for tangents in self._flow.steps[k].tangents_at(part)]


def differentiate_cycle(
    system: System, period: float, turning: Sequence[str], directions: Sequence[Direction], start: Vector,
    closed: float = CLOSED, coarse: float = 1.0, progress: Progress = lambda share: None,
) -> CycleTangents:  # fmt: skip
    """The cycle of that period (s) near the state `start`, as `find_cycle` finds one, and its tangents.

    A change of states by `closed` over the period is none; errors of steps may be `coarse` times as large.
    `progress` gets the share that is done: it is not known how often the period is computed again.
    ModelError where no kernel's derivative is known, or where the motion does not close.
    """
    slopes = _find_slopes(system, directions)
    variation, n = Variation(slopes, coarse), system.state.size
    free = ~list_held(system, turning)
    nominal = system.state.nominal[free]
    x = np.array(start)
    x[~free] = system.x0[~free]
    before = np.inf
    for turn in range(ITERATIONS):
        # Threads of a linear algebra this small wait for each other longer than they compute.
        with threadpool_limits(limits=1, user_api="blas"):
            flow = variation.move(x, period, 0.0, partial(_show_turn, progress, 0.5**turn))
        last = flow.steps[-1]
        ends = np.array([period])
        end, tangents = last.states_at(ends)[0], last.tangents_at(ends)[0]
        missing = (end - x)[free]
        change = float(np.max(np.abs(missing) / (nominal + np.abs(x[free]))))
        turned = tangents[np.ix_(free, free)] * nominal / nominal[:, None]
        # Of each parameter, and what is missing.
        by_period = np.outer(slopes.rates(ends, end[None])[0], [one.period for one in directions])
        right = np.column_stack([(tangents[:, n:] + by_period)[free], missing]) / nominal[:, None]
        moved = close_period(np.eye(nominal.size) - turned, right) * nominal[:, None]
        if change <= closed or change > 0.5 * before:
            break
        before = change
        x[free] += moved[:, -1]
    # Each step may be off by its tolerance.
    if change > max(1e3 * closed, coarse * STATES * len(flow.steps)):
        raise ModelError(
            f"the cycle does not close: a period changes its states by {change:.2g} of their sizes"
        )
    begin = np.zeros((n, len(directions)))
    begin[free] = moved[:, :-1]
    multipliers = np.linalg.eigvals(turned)
    return CycleTangents(system, period, change, multipliers, directions, begin, slopes, flow)


def _show_turn(progress: Progress, left: float, share: float) -> None:
    """Half of what is left is for this turn."""
    progress(1.0 - left + 0.5 * left * share)


def _keep(value: Vector) -> Vector:
    """By how much later a state has its value again: from its changes in each direction, then its rate."""
    return np.zeros(value.size - 1) if value[-1] == 0.0 else -value[:-1] / value[-1]


def differentiate_part(
    system: System, begin: float, duration: float, directions: Sequence[Direction], start: Vector,
    coarse: float = 1.0,
) -> CycleTangents:  # fmt: skip
    """A part of a cycle (s) from the state `start`, which no direction changes, with its tangents."""
    slopes = _find_slopes(system, directions)
    with threadpool_limits(limits=1, user_api="blas"):
        flow = Variation(slopes, coarse).move(start, duration, begin)
    still = np.zeros((start.size, len(directions)))
    return CycleTangents(system, duration, math.nan, np.empty(0), directions, still, slopes, flow)


def differentiate_run(
    system: System, duration: float, turning: str, directions: Sequence[Direction], moved: Vector,
    progress: Progress = lambda share: None,
) -> CycleTangents:  # fmt: skip
    """The motion over a duration (s) from the system's start, which changes by `moved` (states, directions),
    with its tangents. Instants keep the angle `turning`, so the run ends at its angle, not at its time."""
    slopes = _find_slopes(system, directions)
    with threadpool_limits(limits=1, user_api="blas"):
        flow = Variation(slopes).move(system.x0, duration, progress=progress)
    angle = system.state.names.index(turning)
    return CycleTangents(system, duration, math.nan, np.empty(0), directions, moved, slopes, flow, angle)


def _find_slopes(system: System, directions: Sequence[Direction]) -> Slopes:
    index = {name: i for i, name in enumerate(system.parameters.names)}
    return Slopes(
        system, [[(index[name], size) for name, size in one.parameters.items()] for one in directions]
    )
