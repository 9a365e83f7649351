"""scipy's DOP853 with the arithmetic of a step in compiled code.

The tables are scipy's (Hairer, Norsett and Wanner, Solving Ordinary Differential Equations I, section II.10);
the error estimate, the interpolant and the step size control are written as there.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from scipy.integrate import DOP853
from scipy.integrate._ivp import dop853_coefficients as table
from scipy.integrate._ivp.rk import MAX_FACTOR, MIN_FACTOR, SAFETY, Dop853DenseOutput

from ..compile.kernel import kernel
from ..core.quantities import Vector
from .problem import CompiledProblem

# Rows of the table: the first stage, the stages of a step with the rate at its end, those of the interpolant.
A, C, E3, E5, D = table.A, table.C, table.E3, table.E5, table.D
FIRST, END, INTERPOLANT = 1, table.N_STAGES + 1, table.N_STAGES_EXTENDED


class CompiledDop853(DOP853):  # type: ignore[misc]
    """DOP853 for a problem whose rate is compiled."""

    t: float
    y: Vector
    f: Vector
    h_abs: float

    def __init__(self, problem: CompiledProblem, *arguments: Any, **options: Any) -> None:
        super().__init__(*arguments, **options)
        self._problem = problem
        self._stages = make_stages(problem.flat_rate)
        self._z = np.empty(self.n)
        self._atol = np.full(self.n, self.atol)

    def _evaluate(self, first: int, last: int, t: float, y: Vector, h: float) -> None:
        """Rates of the stages from `first` to before `last`; `_z` is the last stage's state."""
        K = self.K_extended
        while (first := self._stages(first, last, t, y, h, K, self._z, *self._problem.memory)) < last:
            K[first] = self.fun(t + C[first] * h, self._z)  # with algebraic loops that are left to Newton
            first += 1

    def _step_impl(self) -> tuple[bool, str | None]:
        t, y = self.t, self.y
        shortest = 10.0 * abs(np.nextafter(t, np.inf) - t)
        h_abs = max(shortest, min(self.h_abs, self.max_step))
        self.K[0] = self.f
        most = MAX_FACTOR
        while h_abs >= shortest:
            t_new = min(t + h_abs, self.t_bound)
            h_abs = t_new - t
            self._evaluate(FIRST, END, t, y, h_abs)
            error = _error_norm(self.K, h_abs, y, self._z, self._atol, self.rtol)
            factor = MAX_FACTOR if error == 0.0 else SAFETY * error**self.error_exponent
            if error < 1.0:
                self.h_previous, self.y_old = h_abs, y
                self.t, self.y, self.f = t_new, self._z.copy(), self.K[-1].copy()
                self.h_abs = h_abs * min(most, factor)
                return True, None
            h_abs *= max(MIN_FACTOR, factor)
            most = 1.0
        return False, self.TOO_SMALL_STEP

    def _dense_output_impl(self) -> Any:
        self._evaluate(END, INTERPOLANT, self.t_old, self.y_old, self.h_previous)
        F = np.empty((table.INTERPOLATOR_POWER, self.n))
        _interpolant(self.K_extended, self.h_previous, self.y_old, self.y, self.f, F)
        return Dop853DenseOutput(self.t_old, self.t, self.y_old, F)


@kernel
def _error_norm(K: Any, h: float, y: Any, z: Any, atol: Any, rtol: float) -> float:
    """Estimate of order 5, damped by that of order 3, over the tolerance; a step is kept below 1."""
    fifth = third = 0.0
    for i in range(y.shape[0]):
        e5 = e3 = 0.0
        for s in range(K.shape[0]):
            e5 += E5[s] * K[s, i]
            e3 += E3[s] * K[s, i]
        scale = atol[i] + max(abs(y[i]), abs(z[i])) * rtol
        fifth += (e5 / scale) ** 2
        third += (e3 / scale) ** 2
    if fifth == 0.0 and third == 0.0:
        return 0.0
    return h * fifth / math.sqrt((fifth + 0.01 * third) * y.shape[0])


@kernel
def _interpolant(K: Any, h: float, y_old: Any, y: Any, f: Any, F: Any) -> None:
    """Coefficients of the continuous extension of order 7 over the step just made."""
    for i in range(y.shape[0]):
        change, slope = y[i] - y_old[i], K[0, i]
        F[0, i] = change
        F[1, i] = h * slope - change
        F[2, i] = 2.0 * change - h * (f[i] + slope)
        for n in range(D.shape[0]):
            total = 0.0
            for s in range(D.shape[1]):
                total += D[n, s] * K[s, i]
            F[3 + n, i] = h * total


def make_stages(rate: Any) -> Any:
    """stages(first, last, t, y, h, K, z, *memory): the stage whose rate is left open, or `last`."""

    @kernel
    def stages(
        first: int, last: int, t: float, y: Any, h: float, K: Any, z: Any, memory: Any, energies: Any
    ) -> int:
        for s in range(first, last):
            for i in range(y.shape[0]):
                total = 0.0
                for j in range(s):
                    total += A[s, j] * K[j, i]
                z[i] = y[i] + h * total
            if not rate(t + C[s] * h, z, memory, energies, K[s]):
                return s
        return last

    return stages
