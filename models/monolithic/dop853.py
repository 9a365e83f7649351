"""scipy's DOP853, whose steps are judged inside too, and the same with a step's arithmetic in compiled code.

The tables are scipy's (Hairer, Norsett and Wanner, Solving Ordinary Differential Equations I, section II.10);
the error estimate, the interpolant and the step size control are written as there.

The estimate judges a step's end alone, and as a difference of formulas it has zeros: for y' = -k y at steps
of 5.7/k, for the film of a cam contact at four of its relaxation times. There a step passes whose interpolant
u is off by thousands of tolerances. The second judge is the defect h (f(t, u(t)) - u'(t)), at two thirds of
the step, where it is largest: u is off by an eighth of it in smooth steps, and by less than all of it over a
corner of the equations.
"""

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
JUDGED = 2.0 / 3.0
# Largest defect over the tolerance: what `reference.SHARPER` leaves between a step and what the user asks.
LARGEST_DEFECT = 100.0
# u is y_old and the sum of F_n x^a (1 - x)^b over n; the terms' values and slopes at JUDGED.
_powers = (np.arange(table.INTERPOLATOR_POWER) + 2) // 2, (np.arange(table.INTERPOLATOR_POWER) + 1) // 2
VALUES = JUDGED ** _powers[0] * (1.0 - JUDGED) ** _powers[1]
SLOPES = VALUES * (_powers[0] / JUDGED - _powers[1] / (1.0 - JUDGED))


class JudgedDop853(DOP853):  # type: ignore[misc]
    """DOP853 that halves a step while the defect is too large."""

    t: float
    y: Vector
    f: Vector
    h_abs: float
    _u: Dop853DenseOutput

    def __init__(self, *arguments: Any, **options: Any) -> None:
        super().__init__(*arguments, **options)
        self._atol = np.full(self.n, self.atol)

    def _step_impl(self) -> tuple[bool, str | None]:
        begin, halved = (self.t, self.y, self.f), False
        while True:
            done, message = self._try_step()
            if not done:
                return done, message
            h, self.t_old = self.t - begin[0], begin[0]
            self._u = super().dense_output()
            if self._defect(h) <= LARGEST_DEFECT or h <= 20.0 * np.spacing(self.t):
                break
            (self.t, self.y, self.f), self.h_abs, halved = begin, 0.5 * h, True
        if halved:  # as after a step that the estimate has refused
            self.h_abs = min(self.h_abs, h)
        return done, message

    def _try_step(self) -> tuple[bool, str | None]:
        """A step that the estimate accepts."""
        return super()._step_impl()

    def _defect(self, h: float) -> float:
        """The largest element of the defect over the tolerance."""
        z = np.empty(self.n)
        inside(self._u.F, self.y_old, z)
        rate = self.fun(self.t_old + JUDGED * h, z)
        return defect_norm(self._u.F, h * rate, self.y_old, self.y, self._atol, self.rtol)

    def dense_output(self) -> Dop853DenseOutput:
        """The interpolant of the step just made."""
        return self._u


class CompiledDop853(JudgedDop853):
    """The same for a problem whose rate is compiled."""

    def __init__(self, problem: CompiledProblem, *arguments: Any, **options: Any) -> None:
        super().__init__(*arguments, **options)
        self._problem = problem
        self._stages = make_stages(problem.flat_rate)
        self._z = np.empty(self.n)

    def _evaluate(self, first: int, last: int, t: float, y: Vector, h: float) -> None:
        """Rates of the stages from `first` to before `last`; `_z` is the last stage's state."""
        K = self.K_extended
        while (first := self._stages(first, last, t, y, h, K, self._z, *self._problem.memory)) < last:
            K[first] = self.fun(t + C[first] * h, self._z)  # with algebraic loops that are left to Newton
            first += 1

    def _try_step(self) -> tuple[bool, str | None]:
        t, y = self.t, self.y
        shortest = 10.0 * abs(np.nextafter(t, np.inf) - t)
        h_abs = max(shortest, min(self.h_abs, self.max_step))
        self.K[0] = self.f
        most = MAX_FACTOR
        while h_abs >= shortest:
            t_new = min(t + h_abs, self.t_bound)
            h_abs = t_new - t
            self._evaluate(FIRST, END, t, y, h_abs)
            error = error_norm(self.K, h_abs, y, self._z, self._atol, self.rtol)
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
        interpolant(self.K_extended, self.h_previous, self.y_old, self.y, self.f, F)
        return Dop853DenseOutput(self.t_old, self.t, self.y_old, F)


@kernel
def inside(F: Any, y_old: Any, z: Any) -> None:
    """z = u at JUDGED."""
    for i in range(z.shape[0]):
        z[i] = y_old[i]
        for n in range(F.shape[0]):
            z[i] += VALUES[n] * F[n, i]


@kernel
def defect_norm(F: Any, change: Any, y_old: Any, y: Any, atol: Any, rtol: float) -> float:
    """The largest element of `change`, h times the rate at JUDGED, less that of u, over the tolerance."""
    largest = 0.0
    for i in range(y.shape[0]):
        defect = change[i]
        for n in range(F.shape[0]):
            defect -= SLOPES[n] * F[n, i]
        defect = abs(defect) / (atol[i] + max(abs(y_old[i]), abs(y[i])) * rtol)
        if defect > largest or math.isnan(defect):
            largest = defect
    return largest


@kernel
def error_norm(K: Any, h: float, y: Any, z: Any, atol: Any, rtol: float) -> float:
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
def interpolant(K: Any, h: float, y_old: Any, y: Any, f: Any, F: Any) -> None:
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
