"""Method B: scipy's DOP853, or Radau where the problem is stiff, with its own event location.

The guards are sampled along every step's continuous extension; a dip between samples is searched for.
"""

from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np
from scipy.integrate import Radau
from scipy.optimize import brentq, minimize_scalar

from ..core.quantities import Vector
from ..core.system import ModelError
from .dop853 import CompiledDop853, JudgedDop853
from .problem import Problem, SystemProblem

# Where a step's guards are sampled, as fractions of it.
FRACTIONS = np.linspace(0.0, 1.0, 9)


class RungeKutta:
    """Explicit order 8 (DOP853), or the implicit order 5 of Radau where `stiff`."""

    def __init__(self, problem: Problem, tolerance: float, stiff: bool, longest_step: float) -> None:
        self.name = f"scipy {'Radau' if stiff else 'DOP853'}, relative tolerance {tolerance:g}"
        self._problem = problem
        self._class: Any = Radau if stiff else JudgedDop853
        if not stiff and isinstance(problem, SystemProblem):
            self._class = partial(CompiledDop853, problem)
        self._options = {"rtol": tolerance, "atol": tolerance * problem.nominal, "max_step": longest_step}
        self._solver: Any = None
        self._dense: Any = None
        self._event: tuple[float, int] | None = None

    def begin(self, t: float, z: Vector, end: float) -> None:
        def rate(at: float, state: Vector) -> Vector:
            # Radau's differences come as columns of a matrix, which kernels cannot read as records.
            return self._problem.rate(at, np.ascontiguousarray(state)).copy()

        self._solver = self._class(rate, t, z, end, **self._options)
        self._dense, self._event = None, None

    def to(self, target: float) -> tuple[float, Vector, tuple[int, ...]]:
        while True:
            if self._event is not None and self._event[0] <= target:
                at, guard = self._event
                return at, self._interpolate(at), (guard,)
            if self._solver.t_old is not None and self._solver.t >= target:
                return target, self._interpolate(target), ()
            message = self._solver.step()
            if self._solver.status == "failed":
                raise ModelError(
                    f"{self.name} failed at t = {self._solver.t:.9g} s: {message} Relax the tolerance, or "
                    "look for a state that is no longer finite"
                )
            self._dense = None
            if self._problem.guard_count:
                self._event = self._first_event(self._solver.t_old, self._solver.t)

    def _interpolate(self, t: float) -> Vector:
        """The state at t inside the step just made."""
        if self._dense is None:  # most steps between close targets are never asked
            self._dense = self._solver.dense_output()
        return np.array(self._dense(t))

    def _first_event(self, start: float, end: float) -> tuple[float, int] | None:
        """Time and number of the first guard to fall in the step just made."""
        instants = start + (end - start) * FRACTIONS
        samples = np.array([self._problem.guards(t, self._interpolate(t)).copy() for t in instants])
        samples[0] = np.maximum(samples[0], 0.0)  # the last event is over
        first: tuple[float, int] | None = None
        for guard in range(self._problem.guard_count):
            at = self._fall(guard, instants, samples[:, guard])
            if at is not None and (first is None or at < first[0]):
                first = (at, guard)
        return first

    def _fall(self, guard: int, instants: Vector, samples: Vector) -> float | None:
        """The instant at which this guard falls below zero, if it does."""

        def value(t: float) -> float:
            return float(self._problem.guards(t, self._interpolate(t))[guard])

        for i in range(1, instants.size):
            if samples[i] < 0.0:
                return _root(value, instants[i - 1], instants[i])
            if i + 1 < instants.size and _may_dip(samples[i - 1], samples[i], samples[i + 1]):
                inside = (instants[i - 1], instants[i + 1])
                options = {"xatol": 1e-9 * (inside[1] - inside[0])}
                lowest = minimize_scalar(value, bounds=inside, method="bounded", options=options)
                if lowest.fun < 0.0:
                    return _root(value, instants[i - 1], float(lowest.x))
        return None


def _may_dip(before: float, here: float, after: float) -> bool:
    """True if a parabola through three samples >= 0, widened by half its sagitta, falls below zero."""
    bend = before - 2.0 * here + after
    if here > before or here > after or bend <= 0.0:
        return False
    return here - (after - before) ** 2 / (8.0 * bend) < 0.25 * bend


def _root(value: Callable[[float], float], low: float, high: float) -> float:
    """Where `value` falls from >= 0 at `low` to below zero at `high`; `low` if it is below zero there.

    The value there is not above zero. `high` if it is not below zero when looked at again: an algebraic loop
    is solved from its last guess, and a guard that depends on it may change sign in the last bits.
    """
    if value(low) <= 0.0:
        return float(low)
    if value(high) >= 0.0:
        return float(high)
    # A flat zero takes many iterations.
    found = float(brentq(value, low, high, xtol=1e-300, rtol=4.0 * np.finfo(float).eps, maxiter=5000))
    step = np.spacing(found)
    while value(found) > 0.0 and found + step < high:
        found, step = found + step, 2.0 * step
    return found
