"""The micro-step integrator inside every component: Dormand-Prince 5(4) with error control.

It starts afresh at every call, so that a component's whole evolving data is (t, x): a saved copy of x
restores it exactly. Inputs vary inside the call as polynomials u(t + s) = sum_k U[k] s^k / k!.
"""

from __future__ import annotations

from typing import Any

from ..compile.kernel import kernel
from .quadrature import make_quadrature
from .quantities import Layout

OK = 0
NOT_FINITE = 1
STEP_TOO_SMALL = 2
TOO_MANY_EVENTS = 3
NOT_CONVERGED = 4
TOO_MANY_STEPS = 5

# Micro-steps tried in one call, some seconds of computation. A stiffness of absurd size, whose vibrations
# need more, would keep a step busy for days.
MOST_STEPS = 1_000_000

FAILURES = {
    NOT_FINITE: "the state is no longer finite",
    STEP_TOO_SMALL: "the micro-step had to become smaller than the resolution of time",
    TOO_MANY_EVENTS: "more events than the limit in one step",
    NOT_CONVERGED: "the implicit equations of the step did not converge",
    TOO_MANY_STEPS: (
        f"more than {MOST_STEPS} micro-steps in one step: something moves too fast for it; look for a "
        "stiffness or damping that is too large or a mass that is too small, or take shorter steps"
    ),
}

# Tolerance per micro-step, relative to nominal + |value|: four orders below the 1e-6 that the tightest
# coupled comparison asks for, five above the rounding of a double.
TOLERANCE = 1e-10

# For positions of some 1e-2 m that press a contact which deflects by 1e-6 m: a millionth of its load is
# 1e-12 m, 1e-10 of such a position, and the errors of many micro-steps add up.
FINE_TOLERANCE = 1e-13

# Taylor coefficients that an input may have: value and three derivatives (cubic).
INPUT_COEFFICIENTS = 4

# Vectors that `advance` needs room for: seven stages, trial state, new state, state at the start.
_VECTORS = 10


def work_size(state: Layout, inputs: Layout) -> int:
    """Length of the scratch vector that `advance` needs."""
    return _VECTORS * state.size + inputs.size


@kernel
def copy(target: Any, source: Any) -> None:
    """target = source, for vectors of one length. numba makes of `target[:] = source` a check of shapes
    whose message takes seconds to compile, and that is linked into every kernel that calls this one."""
    for i in range(target.shape[0]):
        target[i] = source[i]


@kernel
def taylor(U: Any, s: float, u: Any) -> None:
    """u = U[0] + U[1] s + U[2] s^2/2 + U[3] s^3/6."""
    for i in range(u.shape[0]):
        u[i] = U[0, i] + s * (U[1, i] + s * (U[2, i] / 2.0 + s * U[3, i] / 6.0))


def make_derivative_along(derivative: Any) -> Any:
    """The flat derivative with inputs taken from their polynomials, s after the start of the step."""

    @kernel
    def derivative_along(t: float, s: float, x: Any, U: Any, u: Any, p: Any, dx: Any) -> None:
        taylor(U, s, u)
        derivative(t + s, x, u, p, dx)

    return derivative_along


def make_runge_kutta(derivative_along: Any, n: int, tolerance: float = TOLERANCE) -> Any:
    """One Dormand-Prince step from x: the new state in `xn`, the scaled error returned.

    k[0:n] must hold the derivative at the start; k[6n:7n] is the derivative at the end (first same as
    last).
    """

    @kernel
    def runge_kutta(
        t: float, s: float, h: float, x: Any, U: Any, u: Any, p: Any, scale: Any, k: Any, xt: Any, xn: Any
    ) -> float:
        k1, k2, k3, k4 = k[0:n], k[n : 2 * n], k[2 * n : 3 * n], k[3 * n : 4 * n]
        k5, k6, k7 = k[4 * n : 5 * n], k[5 * n : 6 * n], k[6 * n : 7 * n]
        for i in range(n):
            xt[i] = x[i] + h * (k1[i] / 5.0)
        derivative_along(t, s + h / 5.0, xt, U, u, p, k2)
        for i in range(n):
            xt[i] = x[i] + h * (3.0 / 40.0 * k1[i] + 9.0 / 40.0 * k2[i])
        derivative_along(t, s + 0.3 * h, xt, U, u, p, k3)
        for i in range(n):
            xt[i] = x[i] + h * (44.0 / 45.0 * k1[i] - 56.0 / 15.0 * k2[i] + 32.0 / 9.0 * k3[i])
        derivative_along(t, s + 0.8 * h, xt, U, u, p, k4)
        for i in range(n):
            xt[i] = x[i] + h * (
                19372.0 / 6561.0 * k1[i]
                - 25360.0 / 2187.0 * k2[i]
                + 64448.0 / 6561.0 * k3[i]
                - 212.0 / 729.0 * k4[i]
            )
        derivative_along(t, s + 8.0 / 9.0 * h, xt, U, u, p, k5)
        for i in range(n):
            xt[i] = x[i] + h * (
                9017.0 / 3168.0 * k1[i]
                - 355.0 / 33.0 * k2[i]
                + 46732.0 / 5247.0 * k3[i]
                + 49.0 / 176.0 * k4[i]
                - 5103.0 / 18656.0 * k5[i]
            )
        derivative_along(t, s + h, xt, U, u, p, k6)
        for i in range(n):
            xn[i] = x[i] + h * (
                35.0 / 384.0 * k1[i]
                + 500.0 / 1113.0 * k3[i]
                + 125.0 / 192.0 * k4[i]
                - 2187.0 / 6784.0 * k5[i]
                + 11.0 / 84.0 * k6[i]
            )
        derivative_along(t, s + h, xn, U, u, p, k7)
        worst = 0.0
        for i in range(n):
            error = h * (
                71.0 / 57600.0 * k1[i]
                - 71.0 / 16695.0 * k3[i]
                + 71.0 / 1920.0 * k4[i]
                - 17253.0 / 339200.0 * k5[i]
                + 22.0 / 525.0 * k6[i]
                - 1.0 / 40.0 * k7[i]
            )
            ratio = abs(error) / (tolerance * (scale[i] + max(abs(x[i]), abs(xn[i]))))
            if ratio > worst or ratio != ratio:  # nan must reject the step, and stays
                worst = ratio
        return worst

    return runge_kutta


def make_advance(
    derivative: Any, state: Layout, inputs: Layout, sample: Any = None, tolerance: float = TOLERANCE
) -> Any:
    """advance(t, h, x, U, p, scale, work) -> status: integrates x in place from t to t + h.

    `derivative` is flat: (t, x, u, p, dx). On failure x is unchanged. `sample` is called along the steps
    that are made (see `quadrature`).
    """
    n, m = state.size, inputs.size
    derivative_along = make_derivative_along(derivative)
    runge_kutta = make_runge_kutta(derivative_along, n, tolerance)
    quadrature = make_quadrature(sample, n)

    @kernel
    def advance(t: float, h: float, x: Any, U: Any, p: Any, scale: Any, work: Any) -> int:
        k, xt, xn = work[0 : 7 * n], work[7 * n : 8 * n], work[8 * n : 9 * n]
        u = work[9 * n : 9 * n + m]
        start = work[9 * n + m : 10 * n + m]
        copy(start, x)
        s, micro, tried = 0.0, h, 0
        derivative_along(t, 0.0, x, U, u, p, k[0:n])
        while s < h:
            tried += 1
            if tried > MOST_STEPS:
                copy(x, start)
                return TOO_MANY_STEPS
            last = s + micro >= h
            if last:
                micro = h - s
            error = runge_kutta(t, s, micro, x, U, u, p, scale, k, xt, xn)
            if error <= 1.0:
                quadrature(t, s, micro, x, xn, k, U, u, p, xt, work)
                s = h if last else s + micro
                for i in range(n):
                    x[i] = xn[i]
                    k[i] = k[6 * n + i]
                micro *= min(5.0, 0.9 * max(error, 1e-10) ** -0.2)
            elif micro <= 1e-14 * h + 4e-16 * abs(t):
                copy(x, start)
                return NOT_FINITE if not error < 1e300 else STEP_TOO_SMALL
            else:
                micro *= max(0.2, 0.9 * error**-0.2) if error < 1e300 else 0.2
        return OK

    return advance
