"""Rates by divided differences over the last instants: exact for polynomials, of their order otherwise."""

import itertools
import math
from collections.abc import Callable

import numpy as np
import pytest

from models.contact.line.differences import (
    INSTANTS,
    append_instant,
    estimate_rate,
    estimate_second_derivative,
    restart,
)
from models.core.quantities import Vector


def followed(function: Callable[[float], float], instants: Vector) -> tuple[float, float]:
    """Rate and second derivative at the last of the instants."""
    table, ages = np.ones((INSTANTS, 1)), np.ones(INSTANTS - 1)
    restart(table, ages, np.array([function(instants[0])]))
    for before, now in itertools.pairwise(instants):
        append_instant(table, ages, np.array([function(now)]), now - before)
    return estimate_rate(table, ages, 0), estimate_second_derivative(table, ages, 0)


UNEVEN = np.array([0.0, 0.3, 0.4, 1.1, 1.35])


@pytest.mark.parametrize("degree", range(INSTANTS))
def test_polynomials_that_the_instants_tell_have_their_rates(degree: int) -> None:
    """Also the first instants of a history: one more than the degree is enough."""
    polynomial = np.polynomial.Polynomial(np.arange(1.0, degree + 2.0) * (-1.0) ** np.arange(degree + 1))
    for count in range(degree + 1, len(UNEVEN) + 1):
        instants = UNEVEN[:count]
        rate, second = followed(polynomial, instants)
        # A hundred roundings of terms of some ten over spaces of a tenth, and over their squares.
        assert rate == pytest.approx(polynomial.deriv(1)(instants[-1]), abs=1e-12)
        assert second == pytest.approx(polynomial.deriv(2)(instants[-1]), abs=1e-11)


def test_orders_of_the_rate_and_of_the_second_derivative() -> None:
    errors = []
    for h in (0.02, 0.01):
        rate, second = followed(math.sin, 1.0 - h * (UNEVEN[-1] - UNEVEN))
        errors.append((abs(rate - math.cos(1.0)), abs(second + math.sin(1.0))))
    orders = np.log2(np.divide(*errors))
    # What is left are terms of the next order, a hundredth.
    assert orders == pytest.approx([INSTANTS - 1, INSTANTS - 2], abs=0.05)


def test_a_jump_is_left_behind() -> None:
    """A history that is begun anew behind it has the rates of what came after."""
    table, ages = np.zeros((INSTANTS, 1)), np.zeros(INSTANTS - 1)
    for value in (0.0, 1.0, 2.0, 3.0):
        append_instant(table, ages, np.array([value]), 0.1)
    restart(table, ages, np.array([100.0]))
    assert (estimate_rate(table, ages, 0), estimate_second_derivative(table, ages, 0)) == (0.0, 0.0)
    append_instant(table, ages, np.array([99.5]), 0.1)
    assert estimate_rate(table, ages, 0) == pytest.approx(-5.0, rel=1e-12)


def test_an_instant_that_follows_too_soon_is_passed_over() -> None:
    """Over 1e-14 s a difference would be a rounding's: 1e-16/1e-14. Passed over, cubics keep their rates."""
    table, ages = np.zeros((INSTANTS, 1)), np.zeros(INSTANTS - 1)
    cubic = np.polynomial.Polynomial([0.1, 2.0, -1.0, 0.5])
    restart(table, ages, np.array([cubic(0.0)]))
    for k in range(1, 5):
        assert append_instant(table, ages, np.array([cubic(0.1 * k)]), 0.1)
    assert not append_instant(table, ages, np.array([cubic(0.4)]), 1e-14)
    assert estimate_rate(table, ages, 0, 1e-14) == pytest.approx(cubic.deriv(1)(0.4), rel=1e-12)
    assert append_instant(table, ages, np.array([cubic(0.5)]), 0.1)
    assert estimate_rate(table, ages, 0) == pytest.approx(cubic.deriv(1)(0.5), rel=1e-12)
