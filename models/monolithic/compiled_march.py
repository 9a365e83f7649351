"""A whole motion without events by DOP853 in one call of compiled code, sampled along its steps.

Steps are those of `dop853`, judged at their ends and inside; what a sample costs is a polynomial.
"""

from typing import Any

import numpy as np
from scipy.integrate import DOP853
from scipy.integrate._ivp.rk import MAX_FACTOR, MIN_FACTOR, SAFETY

from ..compile.kernel import kernel
from ..core.integrator import copy
from ..core.quantities import Vector
from ..core.system import ModelError
from .cycle import move_by_cvode
from .dop853 import (
    END,
    FIRST,
    INTERPOLANT,
    JUDGED,
    LARGEST_DEFECT,
    D,
    defect_norm,
    error_norm,
    inside,
    interpolant,
    make_stages,
)
from .problem import SystemProblem
from .reference import stiffness

EXPONENT = -1.0 / (DOP853.error_estimator_order + 1)
TERMS = 3 + D.shape[0]
OPEN = -1
# The first step is this share of the longest, none this share of the time; the last may be so much longer.
BEGIN, SHORTEST, ROUNDED = 1e-3, 1e-15, 1.0 + 1e-6


class CompiledMarch:
    """A `Move` of one problem; what is stiff, has guards or algebraic loops left open, CVODE moves."""

    def __init__(self, problem: SystemProblem) -> None:
        n = problem.nominal.size
        self._march = make_march(problem.flat_rate)
        self._room = np.empty((INTERPOLANT + TERMS + 4, n))

    def __call__(
        self, problem: SystemProblem, x: Vector, times: Vector, stops: Vector, tolerance: float
    ) -> Vector:
        """ModelError where no step is short enough."""
        z = problem.start(x)
        stiff, longest = stiffness(problem, 0.0, z, times)
        if stiff or problem.guard_count:
            return move_by_cvode(problem, x, times, stops, tolerance)
        rows = np.empty((stops.size, z.size))
        rows[0] = z
        scale = tolerance * problem.nominal
        done = self._march(stops, rows, scale, tolerance, longest, self._room, *problem.memory)
        if done == OPEN:
            return move_by_cvode(problem, x, times, stops, tolerance)
        if done < stops.size:
            raise ModelError(f"DOP853: before t = {stops[done]:.9g} s no step is short enough")
        return rows


def make_march(rate: Any) -> Any:
    """march(times, rows, atol, rtol, longest, room, *memory): fills `rows` behind the first with states
    at `times`; their number, the first that no step reaches, or OPEN where an algebraic loop is left open."""
    stages = make_stages(rate)

    @kernel
    def march(
        times: Any, rows: Any, atol: Any, rtol: float, longest: float, room: Any, memory: Any, energies: Any
    ) -> int:  # fmt: skip
        K, F = room[:INTERPOLANT], room[INTERPOLANT : INTERPOLANT + TERMS]
        y, z, at, change = room[-4], room[-3], room[-2], room[-1]
        t, end, row, h, most = times[0], times[times.shape[0] - 1], 1, BEGIN * longest, MAX_FACTOR
        copy(y, rows[0])
        if not rate(t, y, memory, energies, K[0]):
            return OPEN
        while row < times.shape[0]:
            h = min(h, longest)
            last = end - t <= ROUNDED * h
            if last:
                h = end - t
            if not h > SHORTEST * end:
                return row
            if stages(FIRST, END, t, y, h, K, z, memory, energies) < END:
                return OPEN
            error = error_norm(K[:END], h, y, z, atol, rtol)
            if not error < 1.0:
                h *= max(MIN_FACTOR, SAFETY * error**EXPONENT) if error - error == 0.0 else MIN_FACTOR
                most = 1.0
                continue
            if stages(END, INTERPOLANT, t, y, h, K, at, memory, energies) < INTERPOLANT:
                return OPEN
            interpolant(K, h, y, z, K[END - 1], F)
            inside(F, y, at)
            if not rate(t + JUDGED * h, at, memory, energies, change):
                return OPEN
            for i in range(change.shape[0]):
                change[i] *= h
            if not defect_norm(F, change, y, z, atol, rtol) <= LARGEST_DEFECT:
                h *= 0.5
                most = 1.0
                continue
            while row < times.shape[0] and (last or times[row] <= t + h):
                _sample(F, y, (times[row] - t) / h, rows[row])
                row += 1
            t = t + h
            copy(y, z)
            copy(K[0], K[END - 1])
            h *= min(most, MAX_FACTOR if error == 0.0 else SAFETY * error**EXPONENT)
            most = MAX_FACTOR
        return row

    return march


@kernel
def _sample(F: Any, y: Any, share: float, row: Any) -> None:
    """The interpolant at a share of the step from y."""
    for i in range(row.shape[0]):
        value = 0.0
        for n in range(F.shape[0] - 1, -1, -1):
            value = (value + F[n, i]) * (1.0 - share if n % 2 else share)
        row[i] = y[i] + value
