"""Kushwaha's own way to the film thickness, (37)-(39): a fixed-point iteration in every time step.

h_n = R h0*(W, U, G) exp(-96.775 w_s), w_s = (dh/dt) / u, dh/dt = +-(h_n - h_{n-1}) / dt, from the film
of the step before. The printed (37) has the lower sign; its own text, and a stable film, want the upper.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from scipy.special import wrightomega

from models.core.quantities import Vector

# More iterations find a few more of the slowly converging steps; those counted here oscillate or diverge.
ITERATIONS = 100
RELATIVE_TOLERANCE = 1e-6
# exp of more is no film thickness.
LARGEST_EXPONENT = 300.0
FIRST_INCREASE = 1.05


@dataclass(frozen=True)
class FilmIteration:
    """Film thickness after every step of a turn, and the steps that did not converge."""

    film: Sequence[float]
    failed: Sequence[int]


def iterate(
    steady_film: Vector, velocity: Vector, step: float, squeeze_constant: float, sign: float = 1.0
) -> FilmIteration:
    """Step along a turn; index 0 is the start. A step that fails is given its exact solution (`implicit`)
    or, with the reversed sign, where there may be none, the film of the step before."""
    film = [FIRST_INCREASE * float(steady_film[0])]
    failed = []
    for n in range(1, steady_film.size):
        speed, before = abs(float(velocity[n])), film[-1]
        found = _fixed_point(float(steady_film[n]), before, sign * squeeze_constant, speed * step)
        if found is None:
            failed.append(n)
            found = before
            if sign > 0.0:
                found = solve_implicit_step(float(steady_film[n]), before, squeeze_constant, speed * step)
        film.append(found)
    return FilmIteration(film, failed)


def _fixed_point(steady: float, before: float, constant: float, travel: float) -> float | None:
    if travel <= 0.0:
        return None
    film = before
    for _ in range(ITERATIONS):
        exponent = -constant * (film - before) / travel
        if exponent > LARGEST_EXPONENT:
            return None
        new = steady * math.exp(exponent)
        if new > 0.0 and abs(new - film) <= RELATIVE_TOLERANCE * new:
            return new
        film = new
    return None


def solve_implicit_step(steady: float, before: float, constant: float, travel: float) -> float:
    """The solution of one step: h = a W0(h_ss/a exp(h_prev/a)) with a = |u| dt / C; without motion h_prev."""
    a = travel / constant
    if a <= 0.0 or steady <= 0.0 or before / a > 1e8:
        return before
    return a * float(wrightomega(math.log(steady / a) + before / a).real)
