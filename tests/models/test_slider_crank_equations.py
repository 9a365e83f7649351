"""Equations of the slider-crank against what Farahanchi (F) prints."""

import math

import numpy as np
import pytest
from scipy.optimize import brentq

from models.slider_crank import equations as eq
from models.slider_crank import forms

XI, ALPHA, BETA = eq.THESIS_XI, eq.THESIS_ALPHA, eq.THESIS_BETA
LAMBDA = 0.07


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


def test_impact_is_f_2_17() -> None:
    tau, psi, rate, e = 2.2, 0.013, 0.05, 0.9
    big2 = 1.0 - XI**2 * math.sin(tau) ** 2
    expected = (1 + e) * XI**2 * math.sin(tau) * math.cos(tau) / big2 * psi - e * rate
    assert eq.rebound(rate, eq.wall_rate(tau, 1.0, psi, XI), e) == pytest.approx(expected, rel=1e-14)


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

    Linear in psi, as the motion itself is, it is 4.953 to 5.154 (see the regions): a difference O(psi^2).
    """
    ends = [brentq(published_lower_force, a, b, args=(0.267, 0.02)) for a, b in ((4.8, 5.05), (5.05, 5.3))]
    for name, end, stated in (("beginning", ends[0], 4.957), ("end", ends[1], 5.151)):
        quantity = f"crank angle at the {name} of sliding on the lower wall (rad)"
        record("Slider-crank", quantity, end, stated, "Farahanchi (1991), 2.7", tolerance=1e-3)


@pytest.mark.parametrize(("corrected", "threshold"), [(False, 0.2669), (True, 0.1196)])
def test_threshold_of_permanent_sliding_on_the_upper_wall(corrected: bool, threshold: float, record) -> None:
    angles = np.linspace(0.0, 2.0 * math.pi, 2001)

    def least(damping: float) -> float:
        m = eq.thesis_mechanism(damping, corrected)
        return min(forms.constraint_force(forms.CORRECTED, t, 1.0, 0.0, 0.0, m) for t in angles)

    found, form = brentq(least, 0.01, 0.5), "corrected" if corrected else "as published"
    quantity = f"friction λ from which the slider rests on the upper wall, {form}"
    record("Slider-crank", quantity, found, threshold, "independent evaluation", tolerance=5e-5)
