"""Method A: SUNDIALS CVODE (variable order and step), with its own root finding for the guards."""

import io
import math
from contextlib import redirect_stdout
from typing import Any

import numpy as np
from sksundae.cvode import CVODE

from ..core.quantities import Vector
from ..core.system import ModelError
from .problem import Problem

EVENT_FOUND = 2
# Steps between two targets; beyond, the problem is stiffer than the method that was chosen for it.
STEP_LIMIT = 10_000_000
# After an event steps may reach so far first (share of the largest time), then twice as far each time. The
# first two are of order 1, whose interpolant takes a bounce for a straight line: at a step longer than the
# bounce it leads into the wall at once.
FIRST_REACH = 1e-11


class Cvode:
    """Adams formulas of order 1 to 12, or backward differences of order 1 to 5 where `stiff`.

    Guards are watched at the ends of steps: a guard that dips below zero and returns inside one step is
    not seen (method B looks inside its steps).
    """

    def __init__(self, problem: Problem, tolerance: float, stiff: bool, longest_step: float) -> None:
        self.name = f"CVODE {'BDF' if stiff else 'Adams'}, relative tolerance {tolerance:g}"
        self._problem = problem
        options: dict[str, Any] = {}
        if problem.guard_count:
            options = {"eventsfn": self._guards(), "num_events": problem.guard_count}
        self._solver = CVODE(
            self._rate,
            method="BDF" if stiff else "Adams",
            rtol=tolerance,
            atol=tolerance * problem.nominal,
            max_step=longest_step if math.isfinite(longest_step) else 0.0,
            max_num_steps=STEP_LIMIT,
            **options,
        )
        # SUNDIALS hands out read-only views, for which numba would compile every kernel once more.
        self._z = np.empty(problem.nominal.size)
        # A whole number of zero rate (a mode, a count) must stay one: the corrector's linear algebra gives
        # it a rounding of its own.
        self._whole = np.flatnonzero(problem.whole)
        self._held = np.empty(self._whole.size)
        self._watching = problem.guard_count > 0
        self._end = self._begun = self._reach = 0.0

    def _rate(self, t: float, z: Vector, rate: Vector) -> None:
        self._z[:] = z
        self._z[self._whole] = self._held
        rate[:] = self._problem.rate(t, self._z)

    def _guards(self) -> Any:
        def guards(t: float, z: Vector, values: Vector) -> None:
            self._z[:] = z
            self._z[self._whole] = self._held
            values[:] = self._problem.guards(t, self._z)

        marked: Any = guards
        marked.terminal = [True] * self._problem.guard_count
        marked.direction = [-1] * self._problem.guard_count
        return guards

    def begin(self, t: float, z: Vector, end: float) -> None:
        self._end, self._begun = end, t
        self._reach = FIRST_REACH * max(abs(t), abs(end)) if self._watching else math.inf
        self._held[:] = z[self._whole]
        self._solver.init_step(t, z)

    def along(self, z: Vector, times: Vector) -> Vector:
        """States at `times`, from z at the first; without guards. As `to` each of them, but faster."""
        self.begin(float(times[0]), z, float(times[-1]))
        if times.size == 2:  # for which the solver would return all steps
            return np.array([z, self.to(float(times[-1]))[1]])
        result = self._solver.solve(times, z)
        states = np.array(result.y)
        states[:, self._whole] = self._held
        self._check(result)
        return states

    def to(self, target: float) -> tuple[float, Vector, tuple[int, ...]]:
        while (near := self._begun + self._reach) < target:
            t, z, fallen = self._step(near, near)
            if fallen:
                return t, z, fallen
            self._reach *= 2.0
        return self._step(target, min(near, self._end))

    def _step(self, target: float, stop: float) -> tuple[float, Vector, tuple[int, ...]]:
        with redirect_stdout(io.StringIO()):  # the library prints failures, which are told here
            result = self._solver.step(target, tstop=stop)
        t, z = float(np.ravel(result.t)[-1]), np.array(np.atleast_2d(result.y)[-1])
        z[self._whole] = self._held
        self._check(result)
        if result.status != EVENT_FOUND:
            return target, z, ()
        found = np.atleast_2d(result.i_events)[-1]
        return t, z, tuple(int(k) for k in np.flatnonzero(found))

    def _check(self, result: Any) -> None:
        if not result.success:
            raise ModelError(
                f"{self.name} failed at t = {np.ravel(result.t)[-1]:.9g} s: {result.message}; relax the "
                "tolerance, or look for a state that is no longer finite"
            )
