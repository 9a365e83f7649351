"""Inputs that an FMU holds over a step: the mean of the signal over the step, and the value at its end.

With the mean u_m of the signal u in the place of u, a step of x' = f(x, u) has the local error
h^3/12 (df/dx) (df/du) u': one order more than with the value at the step's start. Outputs that depend on the
input at once, and rates, are those of the end of the step once the FMU has the value there.

Signals are polynomials: row k of `signals` has their k-th derivatives at the start of the step.
"""

from typing import Any

from models.compile.compiled import compiled


@compiled
def mean(signals: Any, column: int, step: float) -> float:
    """Of one signal over the step: the sum over k of u_k h^k/(k + 1)!."""
    total, factor = 0.0, 1.0
    for k in range(signals.shape[0]):
        factor /= k + 1.0
        total += signals[k, column] * factor
        factor *= step
    return total


@compiled
def at_end(signals: Any, row: int, column: int, step: float) -> float:
    """The derivative of order `row` of one signal at the end of the step."""
    total, factor = 0.0, 1.0
    for k in range(row, signals.shape[0]):
        total += signals[k, column] * factor
        factor *= step / (k - row + 1.0)
    return total


@compiled
def average(signals: Any, rows: Any, columns: Any, held: Any, step: float, given: Any) -> None:
    """What is given for the step: means of the `held`, others as they are at its start."""
    for j in range(rows.shape[0]):
        row, column = rows[j], columns[j]
        given[j] = mean(signals, column, step) if held[j] else signals[row, column]


@compiled
def move_to_end(signals: Any, rows: Any, columns: Any, step: float, given: Any) -> None:
    """What is given after the step."""
    for j in range(rows.shape[0]):
        given[j] = at_end(signals, rows[j], columns[j], step)
