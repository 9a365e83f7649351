"""Lifts as sums of splines: closed, at rest at both ends, with exact areas."""

import math

import numpy as np
import pytest

from models.core.quantities import Vector
from models.valve_train.cams.bumps import Bumps

BUMPS = Bumps(math.radians(95.0), math.radians(250.0), 24)


def sample(count: int = 4001) -> tuple[Vector, Vector]:
    angles = np.linspace(BUMPS.begin, BUMPS.end, count)
    return angles, np.random.default_rng(1).normal(size=BUMPS.count)


def test_every_lift_begins_and_ends_at_rest_without_acceleration() -> None:
    ends = np.array([BUMPS.begin, BUMPS.end])
    for derivative in range(3):
        size = np.abs(BUMPS.at(sample()[0], derivative)).max()
        assert np.abs(BUMPS.at(ends, derivative)).max() <= 1e-12 * size
    outside = np.radians([0.0, 94.0, 251.0, 359.0])
    assert not BUMPS.at(outside).any()


def test_acceleration_has_neither_mean_nor_first_moment() -> None:
    """Cubic between knots: Simpson's rule on intervals that end at knots is exact."""
    angles, coefficients = sample(10 * BUMPS.intervals + 1)
    h = angles[1] - angles[0]
    weights = h / 3.0 * np.array([1.0, *([4.0, 2.0] * (angles.size // 2 - 1)), 4.0, 1.0])
    acceleration = BUMPS.at(angles, 2) @ coefficients
    size = weights @ np.abs(acceleration)
    assert abs(weights @ acceleration) <= 1e-12 * size
    # Degree 4: Simpson's error is h^4/180 times the fourth derivative's mean, 4 * 6 * s^(5).
    assert abs(weights @ (acceleration * (angles - BUMPS.begin))) <= 1e-5 * size


def test_areas_are_integrals() -> None:
    angles, coefficients = sample(40001)
    lift = BUMPS.at(angles) @ coefficients
    # Trapezoids of 7e-5 rad, h^2/12 s'' of a lift that changes over 0.1 rad.
    assert np.trapezoid(lift, angles) == pytest.approx(float(BUMPS.areas @ coefficients), rel=1e-6)


def test_symmetric_lifts_are_those_with_equal_coefficients_on_both_sides() -> None:
    for count in (9, 10):
        alike = Bumps(BUMPS.begin, BUMPS.end, count, symmetric=True)
        every, half = Bumps(BUMPS.begin, BUMPS.end, count), np.random.default_rng(1).normal(size=alike.count)
        both = np.append(half, half[::-1][count % 2 :])
        angles = np.linspace(BUMPS.begin + 1e-6, BUMPS.end - 1e-6, 101)
        lift = alike.at(angles) @ half
        np.testing.assert_allclose(lift, every.at(angles) @ both, atol=1e-12)
        np.testing.assert_allclose(lift, lift[::-1], atol=1e-12)
        assert alike.areas @ half == pytest.approx(every.areas @ both)


def test_a_fit_has_the_lift_of_its_coefficients() -> None:
    angles, coefficients = sample(500)
    found = BUMPS.fit(angles, BUMPS.at(angles) @ coefficients, BUMPS.at(angles, 2) @ coefficients)
    np.testing.assert_allclose(found, coefficients, atol=1e-8)
