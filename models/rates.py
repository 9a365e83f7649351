"""Rates of outputs: their total time derivative along the motion, for signals that use slopes.

The rate of an output is d/ds of output(t + s, x + s f, u + s u') at s = 0, where f is the derivative of
the state and u' that of the inputs. This is a function of one variable, only as curved as the output map
itself, and its differences serve all components alike. Steps are counted in the motion's own time T, in
which nothing moves by more than its nominal size (time: one second). Fourth-order central differences of
three lengths are taken: a long one loses little to rounding, a short one stays clear of kinks, such as the
beginning of a contact. Each output has the longest that the next shorter one confirms.

A rate has an error of some 1e-12 of (size of the output)/T: what an output's terms lose in cancellation,
a contact's deflection as difference of two positions, comes to that. At a kink, within 2e-6 T to 3e-5 T of
it, the rate lies between those of both sides.
"""

from __future__ import annotations

from typing import Any

from .kernel import kernel
from .quantities import Layout

# Half widths of the differences, in T: 16 between neighbours. With the two longest the fifth derivative adds
# T^4 y''''' 1e-13; the shortest lose 1e-10 to rounding.
_STEPS = (2.0**-19, 2.0**-15, 2.0**-11, 2.0**-7)
# Removes the second-order error of the shorter of two neighbours.
_RATIO_SQUARED = 256.0


def rates_work_size(state: Layout, inputs: Layout, outputs: Layout) -> int:
    """Length of the scratch vector that the kernel of `make_rates` needs."""
    return 2 * state.size + inputs.size + (1 + len(_STEPS)) * outputs.size


@kernel
def input_rates(U: Any, s: float, du: Any) -> None:
    """du = U[1] + U[2] s + U[3] s^2/2: the slope of the inputs' polynomials."""
    for j in range(du.shape[0]):
        du[j] = U[1, j] + s * (U[2, j] + s * U[3, j] / 2.0)


def make_rates(derivative: Any, output: Any, state: Layout, inputs: Layout, outputs: Layout) -> Any:
    """rates(t, x, u, du, p, work, yd): total time derivatives yd of all outputs (unit per second).

    `derivative` and `output` are flat. Discrete outputs have the rate zero. What is not finite nearby (a
    state or input at the edge of what the output map takes) makes steps shorter; if it is not finite at the
    point, neither is its rate.
    """
    n, m, count = state.size, inputs.size, outputs.size
    state_sizes = (*(float(size) for size in state.nominal), 1.0)  # a tuple of known type also without states
    input_sizes = (*(float(size) for size in inputs.nominal), 1.0)
    discrete = (*(field.quantity.discrete for field in outputs.fields), False)

    @kernel
    def pace(f: Any, du: Any) -> float:
        """1/T: nominal sizes per second of what moves fastest."""
        fastest = 1.0
        for i in range(n):
            fastest = max(fastest, abs(f[i]) / state_sizes[i])
        for j in range(m):
            fastest = max(fastest, abs(du[j]) / input_sizes[j])
        return fastest

    @kernel
    def moved(s: float, t: float, x: Any, u: Any, du: Any, p: Any, f: Any, xs: Any, us: Any, y: Any) -> None:
        for i in range(n):
            xs[i] = x[i] + s * f[i]
        for j in range(m):
            us[j] = u[j] + s * du[j]
        output(t + s, xs, us, p, y)

    @kernel
    def rates(t: float, x: Any, u: Any, du: Any, p: Any, work: Any, yd: Any) -> None:
        f, xs, us = work[0:n], work[n : 2 * n], work[2 * n : 2 * n + m]
        rest = work[2 * n + m :]
        derivative(t, x, u, p, f)
        time = 1.0 / pace(f, du)
        for k in range(len(_STEPS)):
            s = _STEPS[k] * time
            before, change = rest[0:count], rest[(1 + k) * count : (2 + k) * count]
            moved(-s, t, x, u, du, p, f, xs, us, before)
            moved(s, t, x, u, du, p, f, xs, us, change)
            for i in range(count):
                change[i] = (change[i] - before[i]) / (2.0 * s)
        for i in range(count):
            d0, d1 = rest[count + i], rest[2 * count + i]
            d2, d3 = rest[3 * count + i], rest[4 * count + i]
            short = d0 + (d0 - d1) / (_RATIO_SQUARED - 1.0)
            middle = d1 + (d1 - d2) / (_RATIO_SQUARED - 1.0)
            long = d2 + (d2 - d3) / (_RATIO_SQUARED - 1.0)
            yd[i] = long if abs(long - middle) <= abs(middle - short) else short
            if discrete[i]:
                yd[i] = 0.0

    return rates
