"""Rates of outputs: their total time derivative along the motion, for signals that use slopes.

The rate of an output is d/ds of output(t + s, x + s f, u + s u') at s = 0, where f is the derivative of
the state and u' that of the inputs. This is a function of one variable, only as curved as the output map
itself, and its differences serve all components alike. Steps are counted in the motion's own time T, in
which nothing moves by more than its nominal size (time: one second). There are fourth-order central
differences of three lengths. Long ones lose little to rounding, short ones stay clear of kinks, such as the
beginning of a contact. An output has the middle one, or the long one if that agrees better with the middle
than the middle does with the short; it has the short one if this differs from the middle by more than
rounding.

Errors: the rounding of the output over 5e-4 T (middle: 3e-5 T, short: 2e-6 T), that is 1e-13 (1e-12, 1e-11)
of (its largest term)/T or some times that. In a contact, whose deflection is a difference of positions, that
is relative to the positions. With a kink nearer than 3e-5 T the rate lies between those of its two sides.
"""

from typing import Any, NamedTuple

from ..compile.kernel import borrow, kernel, shaped
from .quantities import Layout

# Half widths of the differences, in T, sixteenfold from one to the next. Of the fifth derivative the long
# one leaves (2^-11 2^-7)^2/120 = 1e-13.
_STEPS = (2.0**-19, 2.0**-15, 2.0**-11, 2.0**-7)
# What rounding makes of an output, at most: cancellation may cost seven digits of sixteen. A contact that
# began in the middle difference, 3e-5 T to 5e-4 T ago, makes it wrong by 1e-5 of the output.
_ROUNDING = 1e-9


class Tangent(NamedTuple):
    """A straight line through a point of the motion, along its slopes, and room for a point on it."""

    t: float
    x: Any
    u: Any
    p: Any
    f: Any  # slopes of the state
    du: Any  # slopes of the inputs
    xs: Any
    us: Any


def rates_work_size(state: Layout, inputs: Layout, outputs: Layout) -> int:
    """Length of the scratch vector that the kernel of `make_rates` needs."""
    return 2 * state.size + inputs.size + (2 + len(_STEPS)) * outputs.size


@kernel
def input_rates(U: Any, s: float, du: Any) -> None:
    """du = U[1] + U[2] s + U[3] s^2/2: the slope of the inputs' polynomials."""
    for j in range(du.shape[0]):
        du[j] = U[1, j] + s * (U[2, j] + s * U[3, j] / 2.0)


@kernel
def without_second_order(short: float, long: float) -> float:
    """The fourth-order difference from two central ones, of which one has sixteen times the other's step."""
    return short + (short - long) / 255.0


@kernel
def select_rate(d0: float, d1: float, d2: float, d3: float, rounding: float) -> float:
    """The rate from central differences of rising step; `rounding` as an error of the shortest."""
    short = without_second_order(d0, d1)
    middle = without_second_order(d1, d2)
    long = without_second_order(d2, d3)
    shorter = abs(middle - short)
    if not shorter <= rounding:  # not finite in the middle: this, too
        return short
    return long if abs(long - middle) <= shorter else middle


def make_rates(derivative: Any, output: Any, state: Layout, inputs: Layout, outputs: Layout) -> Any:
    """rates(t, x, u, du, p, work, yd): total time derivatives yd of all outputs (unit per second).

    `derivative` and `output` are flat. Discrete outputs have the rate zero. Where an output is not finite
    within the longer steps the short ones decide; where it is not finite at the point, neither is its rate.
    """
    n, m, count = state.size, inputs.size, outputs.size
    # One element more gives a component without states or inputs a tuple of the same type.
    state_sizes = (*(float(size) for size in state.nominal), 1.0)
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
    def output_after(s: float, w: Tangent, y: Any) -> None:
        for i in range(n):
            w.xs[i] = w.x[i] + s * w.f[i]
        for j in range(m):
            w.us[j] = w.u[j] + s * w.du[j]
        output(w.t + s, w.xs, w.us, w.p, y)

    @kernel
    def rates(t: float, x: Any, u: Any, du: Any, p: Any, work: Any, yd: Any) -> None:
        room = borrow(work)
        f, xs, us = room[0:n], room[n : 2 * n], room[2 * n : 2 * n + m]
        w = Tangent(t, borrow(x), borrow(u), borrow(p), f, borrow(du), xs, us)
        rest = shaped(room[2 * n + m : 2 * n + m + 6 * count], (6, count))
        before, size = rest[0], rest[1]
        derivative(t, x, u, p, f)
        unit = 1.0 / pace(f, du)
        for k in range(3, -1, -1):
            s, difference = _STEPS[k] * unit, rest[2 + k]
            output_after(-s, w, before)
            output_after(s, w, difference)
            for i in range(count):
                size[i] = abs(difference[i])
                difference[i] = (difference[i] - before[i]) / (2.0 * s)
        for i in range(count):
            rounding = _ROUNDING * size[i] / (_STEPS[0] * unit)
            yd[i] = select_rate(rest[2, i], rest[3, i], rest[4, i], rest[5, i], rounding)
            if discrete[i]:
                yd[i] = 0.0

    return rates
