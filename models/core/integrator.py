"""The micro-step integrator inside every component: Dormand-Prince 5(4) with error control.

It restarts at every call: (t, x) is all that evolves, and a saved copy of x restores a component exactly.
Inputs vary inside the call as polynomials u(t + s) = sum_k U[k] s^k / k!.
"""

from typing import Any

from ..compile.kernel import borrow, kernel
from .dormand_prince import Workspace, make_runge_kutta
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
def copy_rows(target: Any, source: Any) -> None:
    """target = source, for tables of one shape."""
    for i in range(target.shape[0]):
        copy(target[i], source[i])


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
        room = borrow(work)
        u, start = room[9 * n : 9 * n + m], room[9 * n + m : 10 * n + m]
        k, xt, xn = room[0 : 7 * n], room[7 * n : 8 * n], room[8 * n : 9 * n]
        w = Workspace(t, borrow(x), borrow(U), borrow(p), borrow(scale), room, u, k, xt, xn)
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
            error = runge_kutta(s, micro, w)
            if error <= 1.0:
                quadrature(s, micro, w)
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
