"""Rates of what is known at the ends of steps alone: of the polynomial through its last instants.

Newton's form: a table whose row j has the divided differences of order j, of which row 0 has the values
themselves, and the ages of the instants before the last. Instants may be unevenly spaced. With all of
INSTANTS the rate has order INSTANTS - 1, the second derivative INSTANTS - 2; while fewer are known, as
after a beginning or a jump, each one less costs an order.

An implicit method tells these rates itself, as those of its last stage, but of what it damps within the
step only to first order, and those of inner stages are no better than these stages.
"""

from typing import Any

from ...compile.kernel import kernel
from ...core.integrator import copy

# Four give rates of third order, which a method of second order does not spoil.
INSTANTS = 4
# An instant that follows after less than this part of the space before it is passed over, as over short
# spaces differences are made of rounding (steps that a master cuts off at an event may be that short).
NEAR = 0.01


@kernel
def restart(table: Any, ages: Any, values: Any) -> None:
    """Only the `values` at the last instant are known: rates are 0 until `follow` has been called."""
    table[:] = 0.0
    copy(table[0], values)
    ages[:] = 0.0


@kernel
def append_instant(table: Any, ages: Any, values: Any, space: float) -> bool:
    """Takes the `values` at `space` (s, positive) after the last instant into table and ages.

    table: (INSTANTS, quantities); ages (s): INSTANTS - 1, of the instants before the last, 0 where there
    is none. False, and nothing is taken, if the instant is too near.
    """
    count = ages.shape[0]
    if space < NEAR * ages[0]:
        return False
    for j in range(count - 1, 0, -1):
        ages[j] = ages[j - 1] + space if ages[j - 1] > 0.0 else 0.0
    ages[0] = space
    for i in range(values.shape[0]):
        difference = values[i]
        for j in range(count):
            before, table[j, i] = table[j, i], difference
            difference = (difference - before) / ages[j] if ages[j] > 0.0 else 0.0
        table[count, i] = difference
    return True


@kernel
def estimate_second_derivative(table: Any, ages: Any, i: int) -> float:
    """The second derivative of quantity i at the last instant."""
    total, product, slope = 0.0, 1.0, 0.0
    for j in range(ages.shape[0]):
        # d/dt of (t - t_1) ... (t - t_j) at the last instant t_0.
        total += 2.0 * table[j + 1, i] * slope
        slope = slope * ages[j] + product
        product *= ages[j]
    return total


@kernel
def estimate_rate(table: Any, ages: Any, i: int, later: float = 0.0) -> float:
    """The rate of quantity i, so much `later` (s) than the last instant: less than to the next instant."""
    total, product = 0.0, 1.0
    for j in range(ages.shape[0]):
        total += table[j + 1, i] * product
        product *= ages[j]
    return total + later * estimate_second_derivative(table, ages, i)
