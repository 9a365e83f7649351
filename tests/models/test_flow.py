"""Power series and the tabulated flow: roots, the Wronskian, and independent integration."""

import math

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

from models.slider_crank.flight.linear import carry
from models.slider_crank.flight.samples import offset_acceleration
from models.slider_crank.flight.series import NEVER, TERMS, bounds_of_bend, divide_by_u, first_fall, next_fall
from models.slider_crank.motions.machine import Machine

from .oscillators import position_at, scratch

COEFFICIENT = st.integers(-50, 50).map(lambda n: n / 50.0)


def series_of(*coefficients: float) -> np.ndarray:
    c = np.zeros(TERMS)
    c[: len(coefficients)] = coefficients
    return c


def fall(c: np.ndarray, length: float = 1.0) -> float:
    return first_fall(c, -1.0, 0.0, bounds_of_bend(c, length)[0], length)


@settings(max_examples=300, deadline=None, derandomize=True)
@given(st.lists(COEFFICIENT, min_size=3, max_size=7), st.floats(0.05, 1.0))
def test_first_root_is_the_smallest_root_of_the_polynomial(rest: list[float], length: float) -> None:
    c = series_of(0.3, *rest)
    roots = np.roots(c[::-1][np.argmax(c[::-1] != 0.0) :])
    # A double root is only found by numpy to the square root of rounding: leave close pairs to the next test.
    real = np.sort(roots[(np.abs(roots.imag) < 1e-6)].real)
    assume(all(abs(a - b) > 1e-3 for a, b in zip(roots, np.roll(roots, 1), strict=True) if len(roots) > 1))
    inside = real[(real >= 0.0) & (real <= length)]
    assume(not len(real) or np.abs(real - length).min() > 1e-6)
    found = fall(c, length)
    if len(inside):
        assert found == pytest.approx(inside[0], abs=1e-9)
    else:
        assert found == NEVER


@pytest.mark.parametrize("place", [0.123, 0.5, 0.987])
def test_double_root_is_seen_to_rounding(place: float) -> None:
    """(u - place)^2 + depth: a miss by 1e-13 is a miss, a dip of 1e-13 is found at its near side."""
    for depth in (1e-3, 1e-8, 1e-13):
        touching = series_of(place**2, -2.0 * place, 1.0)
        touching[0] += depth
        assert fall(touching) == NEVER
        touching[0] -= 2.0 * depth
        assert fall(touching) == pytest.approx(place - math.sqrt(depth), abs=2e-16 / math.sqrt(depth) + 1e-15)


@pytest.mark.parametrize("height", [1e-3, 1e-9, 1e-30])
def test_bounce_of_any_height_has_its_duration_to_relative_accuracy(height: float) -> None:
    """y = height u - u^2 / 2 returns after 2 height."""
    quotient = np.zeros(TERMS)
    divide_by_u(series_of(0.7, -height, 0.5), 1.0, quotient)
    assert next_fall(quotient, 1.0) == pytest.approx(2.0 * height, rel=1e-14)


@pytest.mark.parametrize("form", ["as_published", "corrected"])
@pytest.mark.parametrize("xi", [0.0, 0.303, 0.8])
def test_determinant_over_a_revolution_is_that_of_the_damping(form: str, xi: float, record) -> None:
    """Liouville: exp(-2 pi lambda / a), to rounding accumulated over the cells."""
    machine = Machine(0.3, form=form, xi=xi)
    flow, v = machine.flow, np.eye(2)
    end = position_at(flow, 0.0, 0.0, 0.0)
    end[0] = flow.cells.shape[0]
    carry(flow, position_at(flow, 0.0, 0.0, 0.0), end, v, scratch())
    inertia = machine.alpha / 4.0 + 1.0 + machine.beta
    exact, source = math.exp(-2.0 * math.pi * 0.3 / inertia), "exp(-2πλ/a) (Liouville)"
    quantity = "determinant of the flow over a revolution"
    record("Slider-crank", quantity, np.linalg.det(v), exact, source, relative=5e-13)


@pytest.mark.parametrize("xi", [0.303, 0.9])
def test_flow_is_that_of_the_equation_of_motion(xi: float, record) -> None:
    """Against DOP853 at its tightest, over one revolution."""
    machine = Machine(0.1, xi=xi)
    m, flow = machine.mechanism, machine.flow
    solved = solve_ivp(
        lambda theta, x: [x[1], offset_acceleration(theta, x[0], x[1], m)],
        (0.0, 2.0 * math.pi), [0.01, -0.02], method="DOP853", rtol=1e-13, atol=1e-16,
    )  # fmt: skip
    state = np.array([0.01, -0.02])
    for ends in flow.ends:
        state = ends[0] + state[0] * ends[1] + state[1] * ends[2]
    # DOP853's own error: 1e-13 a step, some hundred steps.
    difference = (state - solved.y[:, -1]) / np.abs(solved.y).max()
    quantity = "error of the free flight over a revolution, relative"
    record("Slider-crank", quantity, difference, 0.0, "DOP853 at 1e-13", tolerance=2e-11)
