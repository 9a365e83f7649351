"""Inputs that an FMU holds over a step: the mean of the signal over the step, and the value at its end.

With the mean u_m of the signal u in the place of u, a step of x' = f(x, u) has the local error
h^3/12 (df/dx) (df/du) u': one order more than with the value at the step's start. Outputs that depend on the
input at once, and rates, are those of the end of the step once the FMU has the value there.

Signals are polynomials: row k of `signals` has their k-th derivatives at the start of the step. A `column` is
the number of one signal, or a vector of several. Nothing is compiled here: an FMU's own process uses it.
"""

from typing import Any


def mean(signals: Any, column: Any, step: float) -> Any:
    """Over the step: the sum over k of u_k h^k/(k + 1)!."""
    total, factor = 0.0, 1.0
    for k in range(signals.shape[0]):
        factor /= k + 1.0
        total = total + signals[k, column] * factor
        factor *= step
    return total


def at_end(signals: Any, row: int, column: Any, step: float) -> Any:
    """The derivative of order `row` at the end of the step."""
    total, factor = 0.0, 1.0
    for k in range(row, signals.shape[0]):
        total = total + signals[k, column] * factor
        factor *= step / (k - row + 1.0)
    return total
