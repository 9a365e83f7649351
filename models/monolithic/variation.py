"""A motion with its tangents: how its states change with their start and with parameters.

The states x' = f(t, x, p) and their tangents S' = f_x S + f_p are solved together by collocation at Radau's
points (Hairer and Wanner, Solving Ordinary Differential Equations II, section IV.5), an L-stable method. The
tangents are those of the computed states, by one linear system a step. Steps end where an event indicator of
a component changes its sign, as where a contact begins: there f has a kink and f_x jumps, or f itself jumps,
so that the tangents do (their saltation). Jumps of states are refused.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from typing import NamedTuple

import numpy as np
from numpy.polynomial import legendre
from scipy.linalg import lu_factor, lu_solve
from scipy.optimize import brentq

from ..core.quantities import Vector
from ..core.system import ModelError, Port
from .slopes import Slopes

Progress = Callable[[float], object]

STAGES = 7
# Errors of a step: of states over nominal sizes, of tangents over these times the largest that each has had.
STATES, TANGENTS = 1e-10, 1e-8
# Of the duration: the first step, and what is at one instant.
FIRST_SHARE, INSTANT = 1e-4, 1e-12
# Of the duration: a step over a kink that no indicator marks, with whatever error of the tangents.
LEAST = 1e-11
LEAST_FACTOR, LARGEST_FACTOR, SAFETY = 0.1, 5.0, 0.8
# Newton's corrections end at rounding.
ROUNDING, STALLED, ITERATIONS = 1e-13, 1e-11, 10
# Where indicators of events are looked at, in each gap between nodes.
INSIDE = (1.0 / 3.0, 2.0 / 3.0)
# Both sides of an event, in instants from it; rates that differ there by less than this part do not jump.
NEAR, JUMP = 10.0, 1e-6


@dataclass(frozen=True)
class Collocation:
    """Nodes in (0, 1], integrals of their polynomials up to each, the polynomials' Legendre coefficients."""

    nodes: Vector
    integrals: Vector
    coefficients: Vector


@cache
def radau() -> Collocation:
    ends = np.zeros(STAGES + 1)
    ends[STAGES], ends[STAGES - 1] = 1.0, -1.0
    points = np.append(np.sort(legendre.legroots(ends).real)[:-1], 1.0)
    inverse = np.linalg.inv(legendre.legvander(points, STAGES - 1))
    return Collocation(0.5 * (points + 1.0), _integrate(points) @ inverse, inverse)


def _integrate(points: Vector) -> Vector:
    """Integrals of Legendre's polynomials over [0, (points + 1)/2]: (P_(k+1) - P_(k-1))/(2 k + 1)/2."""
    values = legendre.legvander(points, STAGES)
    behind = np.hstack([-np.ones((points.size, 1)), values[:, : STAGES - 1]])
    return np.asarray(0.5 * (values[:, 1:] - behind) / (2.0 * np.arange(STAGES) + 1.0))


@dataclass(frozen=True)
class Step:
    """From t over h, from the states x and their tangents; Legendre coefficients of the rates of both."""

    t: float
    h: float
    x: Vector
    rates: Vector
    tangents: Vector
    tangent_rates: Vector

    def states_at(self, times: Vector) -> Vector:
        """(k, n)."""
        return self._move(times, self.x, self.rates)

    def tangents_at(self, times: Vector) -> Vector:
        """(k, n, directions)."""
        return self._move(times, self.tangents, self.tangent_rates)

    def _move(self, times: Vector, start: Vector, rates: Vector) -> Vector:
        weights = _integrate(2.0 * (times - self.t) / self.h - 1.0)
        return np.asarray(start + self.h * np.tensordot(weights, rates, 1))


class Event(NamedTuple):
    """An instant at which an indicator changes its sign, how near to it both sides are, and by how much later
    it is, by direction."""

    t: float
    near: float
    later: Vector


class Flow(NamedTuple):
    """The steps of a motion, and its events."""

    steps: list[Step]
    events: list[Event]


@dataclass(frozen=True)
class _Stages:
    """Of a step: its states and their rates at the nodes."""

    t: float
    h: float
    x: Vector
    states: Vector
    rates: Vector

    @property
    def coefficients(self) -> Vector:
        return radau().coefficients @ self.rates


class Variation:
    """Motions of a system, with tangents in all directions of its slopes.

    Errors of steps may be `coarse` times as large.
    """

    def __init__(self, slopes: Slopes, coarse: float = 1.0) -> None:
        for name, instance in slopes.system.instances.items():
            if instance.component.events:
                raise ModelError(f"{name}: {instance.component.name} has events; its motion has no tangents")
        self._slopes, self._coarse = slopes, coarse
        self._nominal = slopes.system.state.nominal
        n = self._n = self._nominal.size
        outputs = slopes.system.outputs
        self._indicators = [
            outputs.index(Port(name, indicator))
            for name, instance in slopes.system.instances.items()
            for indicator in instance.component.event_indicators
        ]
        self._still = np.zeros((1, slopes.system.p.size))
        self._steps = np.vstack([np.zeros((n, slopes.system.p.size)), slopes.steps])
        # By parameters as exactly as states if they change as a whole, however little a motion answers.
        p, sizes = slopes.system.p, slopes.system.parameters.nominal
        shares = np.max(np.abs(self._steps) / np.where(p == 0.0, sizes, np.abs(p)), axis=1)
        self._least = np.maximum(shares * STATES / TANGENTS, 1e-12)

    def move(
        self,
        x: Vector,
        duration: float,
        begin: float = 0.0,
        progress: Progress = lambda share: None,
    ) -> Flow:
        """From the state `x` at time `begin`, with the tangents by the start, then by parameters. `progress`
        gets the share that is done."""
        found, events, t, h = list[Step](), list[Event](), begin, FIRST_SHARE * duration
        end = begin + duration
        instant = INSTANT * duration
        tangents = np.eye(self._n, self._slopes.count)
        sizes = self._size(tangents)
        slope = self._slopes.at(np.array([t]), x[None])[0]
        while t < end:
            planned = h = min(h, end - t)
            if h < 0.01 * instant:
                raise ModelError(f"tangents: at t = {t:.9g} s no step is short enough")
            stages = self._solve(t, h, x, slope, found[-1] if found else None)
            error = (
                math.inf
                if stages is None
                else _error(h, stages.coefficients, self._coarse * STATES * self._nominal)
            )
            if stages is None or error > 1.0:
                h *= _factor(error)
                continue
            event, indicator = self._find_event(stages, instant)
            if event < math.inf:
                stages = self._solve(t, event - t, x, slope, found[-1] if found else None)
                if stages is None:
                    h = 0.5 * (event - t)
                    continue
            step, after, slopes = self._follow(stages, tangents)
            larger = np.maximum(sizes, self._size(after))
            allowed = self._coarse * TANGENTS * self._nominal[:, None] * larger
            wrong = _error(step.h, step.tangent_rates, allowed)
            if wrong > 1.0 and step.h > LEAST * duration:
                h = step.h * _factor(wrong)
                continue
            found.append(step)
            progress((t - begin) / duration)
            t = end if t + step.h >= end - instant else t + step.h
            x, tangents, sizes, slope = stages.states[-1].copy(), after, larger, slopes[-1]
            if event < math.inf:
                crossed, tangents = self._cross(t, x, tangents, indicator, instant)
                events.append(crossed)
                near = NEAR * instant
                slope = self._slopes.at(np.array([t + near]), (x + near * stages.rates[-1])[None])[0]
            h = max(step.h * _factor(max(error, wrong)), planned if step.h < planned else 0.0)
        return Flow(found, events)

    def _size(self, tangents: Vector) -> Vector:
        """The largest of each, over nominal sizes."""
        return np.asarray(np.maximum(np.max(np.abs(tangents) / self._nominal[:, None], axis=0), self._least))

    def _solve(self, t: float, h: float, x: Vector, slope: Vector, past: Step | None) -> _Stages | None:
        """Newton's method with the slope at the start; None where it fails."""
        c, n = radau(), self._n
        times = t + h * c.nodes
        factors = lu_factor(np.eye(STAGES * n) - h * np.kron(c.integrals, slope[:, :n]), check_finite=False)
        states = np.tile(x, (STAGES, 1))
        if past is not None and h <= 2.0 * past.h and past.t + past.h == t:
            states = past.states_at(times)
        before, sizes = math.inf, self._nominal + np.abs(x)
        for _ in range(ITERATIONS):
            rates = self._slopes.rates(times, states)
            if not np.all(np.isfinite(rates)):
                return None
            missing = (x + h * (c.integrals @ rates) - states).ravel()
            correction = lu_solve(factors, missing, check_finite=False).reshape(states.shape)
            states += correction
            change = float(np.max(np.abs(correction) / sizes))
            if change < ROUNDING or (change < STALLED and change > 0.3 * before):
                return _Stages(t, h, x, states, self._slopes.rates(times, states))
            if change > 2.0 * before:
                return None
            before = change
        return None

    def _follow(self, stages: _Stages, tangents: Vector) -> tuple[Step, Vector, Vector]:
        """The step with its tangents, these at its end, and the slopes at the nodes."""
        c, n, h = radau(), self._n, stages.h
        slopes = self._slopes.at(stages.t + h * c.nodes, stages.states)
        matrix = np.eye(STAGES * n).reshape(STAGES, n, STAGES, n)
        matrix = matrix - h * np.einsum("ij,jab->iajb", c.integrals, slopes[:, :, :n])
        right = np.tile(tangents, (STAGES, 1, 1))
        right[:, :, n:] += h * np.tensordot(c.integrals, slopes[:, :, n:], 1)
        flat = matrix.reshape(STAGES * n, -1), right.reshape(STAGES * n, -1)
        solved = lu_solve(lu_factor(flat[0], check_finite=False), flat[1], check_finite=False)
        solved = solved.reshape(right.shape)
        rates = slopes[:, :, :n] @ solved
        rates[:, :, n:] += slopes[:, :, n:]
        turned = np.tensordot(c.coefficients, rates, 1)
        return Step(stages.t, h, stages.x, stages.coefficients, tangents, turned), solved[-1], slopes

    def _signs(self, times: Vector, states: Vector) -> Vector:
        return np.asarray(self._slopes.evaluation.along(times, states)[1][:, self._indicators])

    def _find_event(self, stages: _Stages, instant: float) -> tuple[float, int]:
        """The first instant in a step at which an indicator changes its sign, and which; infinite if none."""
        step = Step(stages.t, stages.h, stages.x, stages.coefficients, stages.x, stages.x)
        begin, ends = stages.t, stages.t + stages.h * radau().nodes
        first = min(begin + NEAR * instant, 0.5 * (begin + ends[0]))
        gaps = zip([first, *ends[:-1]], ends, strict=True)
        inside = [a + part * (b - a) for a, b in gaps for part in INSIDE]
        times = np.sort([first, *inside, *ends])
        values = self._signs(times, step.states_at(times))
        found = math.inf, 0
        for k in range(values.shape[1]):
            for i in np.flatnonzero(values[:-1, k] * values[1:, k] < 0.0)[:1]:

                def value(t: float, k: int = k) -> float:
                    at = np.array([t])
                    return float(self._signs(at, step.states_at(at))[0, k])

                at = float(brentq(value, times[i], times[i + 1], xtol=0.1 * instant))
                found = min(found, (at, k))
        return found

    def _cross(
        self, t: float, x: Vector, tangents: Vector, indicator: int, instant: float
    ) -> tuple[Event, Vector]:
        """The event and the tangents behind it: where rates jump, S+ = S- + (f- - f+) dt."""
        rate = self._slopes.rates(np.array([t]), x[None])[0]
        near = NEAR * instant
        before, after = self._slopes.rates(
            np.array([t - near, t + near]), np.array([x - near * rate, x + near * rate])
        )
        place = self._indicators[indicator]
        moved = self._slopes.along(t, x, np.ascontiguousarray(tangents.T), self._steps)[2][:, place]
        speed = self._slopes.along(t, x, before[None], self._still)[2][0, place]
        later = -moved / speed if speed != 0.0 else np.zeros_like(moved)
        jump = before - after
        if np.max(np.abs(jump) / self._nominal) > JUMP * np.max(np.abs(rate) / self._nominal):
            tangents = tangents + np.outer(jump, later)
        return Event(t, near, later), tangents


def _error(h: float, coefficients: Vector, sizes: Vector) -> float:
    """What the last coefficient adds, less by as much as coefficients fall, over `sizes`."""
    last = float(np.max(np.abs(coefficients[-1]) / sizes))
    before = float(np.max(np.maximum(np.abs(coefficients[-2]), np.abs(coefficients[-3])) / sizes))
    fall = last / before if before > last else 1.0
    return h * last * fall / (2 * STAGES)


def _factor(error: float) -> float:
    """By which a step may be longer than one with this error over the tolerance."""
    if not math.isfinite(error):
        return 0.25
    return min(LARGEST_FACTOR, max(LEAST_FACTOR, SAFETY * max(error, 1e-30) ** (-1.0 / (STAGES + 1))))
