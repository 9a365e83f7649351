"""Equations of the slider-crank: against the exact mechanism, and against Farahanchi's (F) figures."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.optimize import brentq

from models.slider_crank import energetics, forms
from models.slider_crank import equations as eq

XI, ALPHA, BETA = eq.THESIS_XI, eq.THESIS_ALPHA, eq.THESIS_BETA
LAMBDA = 0.07
SECOND_DIFFERENCE = 1e-3  # step; the error of the differences is about 1e-8


def exact_energy(q: np.ndarray, v: np.ndarray, rod_sign: float) -> float:
    """Kinetic energy over M l^2 of the bodies; the rod turns at phi' + rod_sign psi' (right: -1)."""
    theta, psi = q
    phi = math.asin(XI * math.sin(theta))
    phi_rate = XI * math.cos(theta) / math.cos(phi) * v[0]
    angle, rate = phi - psi, phi_rate - v[1]

    def speed_squared(along: float) -> float:
        x = -XI * v[0] * math.sin(theta) - along * rate * math.sin(angle)
        y = XI * v[0] * math.cos(theta) - along * rate * math.cos(angle)
        return x**2 + y**2

    turning = phi_rate + rod_sign * v[1]
    return 0.5 * (ALPHA * speed_squared(0.5) + speed_squared(1.0) + BETA * turning**2)


def lagrange(q: np.ndarray, v: np.ndarray, w: np.ndarray, rod_sign: float) -> np.ndarray:
    """d/dt dT/dv - dT/dq of the exact energy, by differences (T is quadratic in v: exact there)."""
    d = SECOND_DIFFERENCE

    def momentum(at: np.ndarray, speed: np.ndarray) -> np.ndarray:
        steps = np.eye(2)
        return np.array(
            [
                (exact_energy(at, speed + e, rod_sign) - exact_energy(at, speed - e, rod_sign)) / 2.0
                for e in steps
            ]
        )

    def along(f, at):  # sixth-order central difference
        return (
            45 * (f(at, d) - f(at, -d)) - 9 * (f(at, 2 * d) - f(at, -2 * d)) + f(at, 3 * d) - f(at, -3 * d)
        ) / (60 * d)

    rate = along(lambda _, s: momentum(q + s * v + 0.5 * s**2 * w, v + s * w), None)
    slope = np.array([along(lambda _, s, e=e: exact_energy(q + s * e, v, rod_sign), None) for e in np.eye(2)])
    return rate - slope


def friction(q: np.ndarray, v: np.ndarray) -> np.ndarray:
    """Generalised friction moments of the crank pin on (theta, psi)."""
    slope = XI * math.cos(q[0]) / math.sqrt(1.0 - (XI * math.sin(q[0])) ** 2)
    joint = v[0] * (1.0 + slope) - v[1]
    return LAMBDA * joint * np.array([-(1.0 + slope), 1.0])


STATES = [(0.3, 1.0, 0.0), (2.1, 1.0, 0.0), (4.4, 0.7, -0.6), (5.9, -1.3, 0.8)]


def residuals(corrected: bool, rod_sign: float, size: float, state: tuple[float, float, float]) -> np.ndarray:
    """What is left of the exact Lagrange equations when psi'' and the torque are the linear model's."""
    theta, speed, acceleration = state
    m = eq.thesis_mechanism(LAMBDA, corrected)
    psi, rate = 0.8 * size, -0.6 * size
    change = eq.flight_acceleration(theta, speed, acceleration, psi, rate, m)
    torque = energetics.crank_torque(theta, speed, acceleration, psi, rate, change, 0.0, m)
    q, v, w = np.array([theta, psi]), np.array([speed, rate]), np.array([acceleration, change])
    return lagrange(q, v, w, rod_sign) - friction(q, v) - np.array([torque, 0.0])


@pytest.mark.parametrize("state", STATES)
@pytest.mark.parametrize(("corrected", "rod_sign"), [(True, -1.0), (False, 1.0)])
def test_motion_and_torque_agree_with_lagrange_to_first_order(
    corrected: bool, rod_sign: float, state: tuple[float, float, float], record
) -> None:
    """Exact at psi = 0; the residual falls with psi^2. F's form needs its phi' + psi' for that."""
    at_zero = residuals(corrected, rod_sign, 0.0, state)
    quantity = f"what Lagrange's equations leave at psi = 0, {'corrected' if corrected else 'as published'}"
    record("Slider-crank", quantity, at_zero, 0.0, "energies of the bodies", tolerance=1e-10)
    large, small = (residuals(corrected, rod_sign, size, state) for size in (0.02, 0.01))
    assert np.abs(large).max() > 1e-6
    assert np.abs(large - 4.0 * small).max() < 0.05 * np.abs(large).max()


@pytest.mark.parametrize("state", STATES)
def test_published_form_is_not_the_mechanism(state: tuple[float, float, float]) -> None:
    """With the rod's true rotation phi' - psi' F's equation leaves 2 beta phi''."""
    theta, speed, acceleration = state
    bend = eq.rod_curvature(theta, XI) * speed**2 + eq.rod_slope(theta, XI) * acceleration
    left = residuals(False, -1.0, 0.0, state)[1]
    assert left == pytest.approx(-2.0 * BETA * bend, abs=1e-10)
    assert abs(left) > 0.05


@pytest.mark.parametrize("sign", [-1.0, 1.0])
def test_constant_speed_form_is_f_2_13(sign: float, record) -> None:
    """a, c and f as F prints them (with -beta), and with +beta."""
    m = eq.thesis_mechanism(LAMBDA, corrected=sign > 0.0)
    tau, psi, rate = 1.234, 0.01, -0.02
    big = math.sqrt(1.0 - XI**2 * math.sin(tau) ** 2)
    c = (1 + ALPHA / 2) * XI * big * math.cos(tau) - (1 + ALPHA / 2) * XI**2 * math.sin(tau) ** 2
    f = (
        (ALPHA / 4 + 1 + sign * BETA) * (XI**3 - XI) * math.sin(tau) / big**3
        + (XI * big + ALPHA / 2 * XI * big) * math.sin(tau)
        + (XI**2 / 2 + XI**2 * ALPHA / 4) * math.sin(2 * tau)
        + LAMBDA
        + LAMBDA * XI * math.cos(tau) / big
    )
    a = ALPHA / 4 + 1 + BETA
    expected = (f - c * psi - LAMBDA * rate) / a
    found = eq.flight_acceleration(tau, 1.0, 0.0, psi, rate, m)
    quantity = "acceleration of the rod at constant speed"
    record("Slider-crank", quantity, found, expected, "Farahanchi (1991), (2.13)", relative=1e-14)


def test_wall_rates_are_derivatives_of_the_wall() -> None:
    speed, acceleration, gap, d = 1.7, -0.9, 0.02, 1e-4
    at = lambda t: eq.wall_angle(0.6 + speed * t + 0.5 * acceleration * t**2, gap, XI)  # noqa: E731
    psi = at(0.0)
    assert eq.wall_rate(0.6, speed, psi, XI) == pytest.approx((at(d) - at(-d)) / (2 * d), rel=1e-6)
    second = (at(d) - 2.0 * psi + at(-d)) / d**2
    assert eq.wall_acceleration(0.6, speed, acceleration, psi, XI) == pytest.approx(second, rel=1e-6)


def test_impact_is_f_2_17() -> None:
    tau, psi, rate, e = 2.2, 0.013, 0.05, 0.9
    big2 = 1.0 - XI**2 * math.sin(tau) ** 2
    expected = (1 + e) * XI**2 * math.sin(tau) * math.cos(tau) / big2 * psi - e * rate
    assert eq.rebound(rate, eq.wall_rate(tau, 1.0, psi, XI), e) == pytest.approx(expected, rel=1e-14)


def wall_force(tau: float, side: float, damping: float, gap: float, corrected: bool = False) -> float:
    m = eq.thesis_mechanism(damping, corrected)
    psi = eq.wall_angle(tau, side * gap, XI)
    return side * forms.constraint_force(forms.CORRECTED, tau, 1.0, 0.0, psi, m)


def published_lower_force(tau: float, damping: float, gap: float) -> float:
    """F (2.29) as printed, not linear in psi, on the linear wall (2.15); times a positive factor."""
    d = 1e-4
    phi = lambda t: math.asin(XI * math.sin(t))  # noqa: E731
    psi = lambda t: -gap / math.cos(phi(t))  # noqa: E731
    first = lambda f: (f(tau + d) - f(tau - d)) / (2.0 * d)  # noqa: E731
    second = lambda f: (f(tau + d) - 2.0 * f(tau) + f(tau - d)) / d**2  # noqa: E731
    swing = second(phi) - second(psi)
    return (
        -(1.0 + ALPHA / 2.0) * XI * math.sin(tau + phi(tau) - psi(tau))
        - (1.0 + ALPHA / 4.0) * swing
        + BETA * (second(phi) + second(psi))
        - damping * (1.0 + first(phi) - first(psi))
    )


def test_interval_of_lower_wall_sliding_in_f_2_7(record) -> None:
    """lambda = 0.267, rho = 0.02: 4.957 < theta < 5.151 by F's own (2.29).

    Linear in psi, as the motion itself is, the interval is 4.953 to 5.154: a difference O(psi^2).
    """
    ends = [brentq(published_lower_force, a, b, args=(0.267, 0.02)) for a, b in ((4.8, 5.05), (5.05, 5.3))]
    for name, end, stated in (("beginning", ends[0], 4.957), ("end", ends[1], 5.151)):
        quantity = f"crank angle at the {name} of sliding on the lower wall (rad)"
        record("Slider-crank", quantity, end, stated, "Farahanchi (1991), 2.7", tolerance=1e-3)
    ends = [brentq(wall_force, a, b, args=(-1.0, 0.267, 0.02)) for a, b in ((4.8, 5.05), (5.05, 5.3))]
    assert ends == pytest.approx([4.9531, 5.1541], abs=1e-4)


@pytest.mark.parametrize(("corrected", "threshold"), [(False, 0.2669), (True, 0.1196)])
def test_threshold_of_permanent_sliding_on_the_upper_wall(corrected: bool, threshold: float, record) -> None:
    angles = np.linspace(0.0, 2.0 * math.pi, 2001)
    least = lambda damping: min(wall_force(t, 1.0, damping, 0.0, corrected) for t in angles)  # noqa: E731
    found, form = brentq(least, 0.01, 0.5), "corrected" if corrected else "as published"
    quantity = f"friction λ from which the slider rests on the upper wall, {form}"
    record("Slider-crank", quantity, found, threshold, "independent evaluation", tolerance=5e-5)


def test_symmetries_of_the_wall_forces() -> None:
    """At rho = 0 the walls' forces are opposite; at lambda = 0 the reflected crank reverses them.

    (F 2.6 says half a turn reverses them: its own force has a part in sin 2 theta.)
    """
    for tau in (0.4, 1.9, 3.3):
        assert wall_force(tau, 1.0, 0.1, 0.0) == pytest.approx(-wall_force(tau, -1.0, 0.1, 0.0), rel=1e-14)
        reflected = wall_force(-tau, 1.0, 0.0, 0.0)
        assert reflected == pytest.approx(-wall_force(tau, 1.0, 0.0, 0.0), rel=1e-12)
