"""Tangent dynamics: exponents, their sum, the impact oscillator."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from models.slider_crank.flight import histories as h
from models.slider_crank.flight.bouncing import END, RATE_OF_Y, UPPER, phase
from models.slider_crank.flight.linear import carry, kick
from models.slider_crank.flight.tangent import across_impact
from models.slider_crank.machine import FORMS, Machine, Motion
from tests.models.oscillators import impact_oscillator, impact_oscillator_orbit, position_at, scratch
from tests.models.test_slider_crank_motions import EXPONENTS

from .table import Row

BOUNCING = "models/test_bouncing.py::"
MOTIONS = "models/test_slider_crank_motions.py::"
TURNS = 400_000


def rows() -> Iterator[Row]:
    sums, parts, worst = [], [], 0.0
    for damping, gap, reference in EXPONENTS:
        found = Motion(Machine(damping, gap, form="as_published")).skip(500).exponents(TURNS)
        parts.append(f"({damping}, {gap}): {found.largest:+.4f} ± {found.uncertainty:.4f} ({reference:+.3f})")
        worst = max(worst, abs(found.largest / reference - 1.0))
        sums.append(abs(found.largest + found.second - found.exact_sum))
    nonlinear = Motion(Machine(0.025, 0.02, form=FORMS[2])).skip(100).exponents(20_000)
    sums.append(abs(nonlinear.largest + nonlinear.second - nonlinear.exact_sum))
    yield Row(
        "tangent dynamics with saltation at impacts, sliding onset and release: full spectrum",
        "derivative of the motion over a revolution, three forms, by differences",
        (BOUNCING + "test_tangent_vectors_are_the_derivative_of_the_motion",),
    )
    yield Row(
        "the sum identity (−λ/a + 2N ln e/2π) to 1e-6",
        f"{max(sums[:-1]):.0e} (linear, {TURNS} turns), {sums[-1]:.0e} (nonlinear)",
        (MOTIONS + "test_lyapunov_exponents",),
    )
    yield Row(
        "the listed exponents to 2 %",
        f"{'; '.join(parts)}; largest difference {100.0 * worst:.1f} %",
        (MOTIONS + "test_lyapunov_exponents_long",),
        short="" if worst <= 0.02 else "beyond 2 %: the listed value is of a shorter run.",
    )
    yield _oscillator()


def _oscillator() -> Row:
    omega, r = 2.8, 0.8
    orbit = impact_oscillator_orbit(omega, r, 0.0, -1.0)
    flow, walls = impact_oscillator(omega, r, 0.0)
    start = position_at(flow, orbit.phase, 0.0, -r * orbit.velocity / omega)
    v, position, last = np.eye(2), start.copy(), flow.cells.shape[0] - 1
    for _ in range(2):
        code = h.LINEAR.next_event(flow, walls, position, last, 1.0, scratch())
        carry(flow, start, position, v, scratch())
        if code == END:
            h.begin_cycle(position)
            start = position.copy()
    errors = phase(flow, position) - orbit.phase, omega * position[RATE_OF_Y] - orbit.velocity
    across_impact(r, kick(flow, walls, position, UPPER), position[RATE_OF_Y], v)
    return Row(
        "the analytic impact-oscillator orbit to 1e-11 through the same event machinery",
        f"phase to {abs(errors[0]):.0e}, velocity to {abs(errors[1]):.0e}, trace of the multipliers to "
        f"{abs(np.trace(v) - orbit.trace):.0e}, determinant r² to {abs(np.linalg.det(v) - r**2):.0e}",
        (
            BOUNCING + "test_impact_oscillator_returns_to_its_orbit",
            BOUNCING + "test_multipliers_of_the_impact_oscillator",
        ),
    )
