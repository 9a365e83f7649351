"""Sections 3 and 4.4: the film formula (10), its ranges, and the paper's iteration for squeeze (37)-(39)."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache

import numpy as np
from scipy.special import wrightomega

from models.contact.films import FILMS
from models.contact.films.groups import Conditions, groups
from models.contact.hertz import pair_compliance
from models.core.quantities import Vector

from ..statement import Values
from .parts import find_nose_contact
from .runs import AS_PRINTED, KINEMATIC_SPEED, NEGATIVE, Runs

STEPS = 500  # per turn
ANGLES_DEG: Vector = np.asarray(np.arange(STEPS + 1) * (360.0 / STEPS))
TABLE_3_FLAGS = {"G*": "material", "w_s*": "squeeze", "W*": "load", "U*": "speed"}
# A formula for the same central film, fitted to numerical solutions by others.
COMPARED = "pan_hamrock_central"
# More iterations find a few more of the slowly converging steps; those counted here oscillate or diverge.
ITERATIONS = 100
RELATIVE_TOLERANCE = 1e-6
# The exponential of more is no film thickness.
LARGEST_EXPONENT = 300.0
FIRST_INCREASE = 1.05


def _compute_film(runs: Runs, name: str, load: float, speed: float, radius: float) -> float:
    p = runs.parameters("contact")
    at = Conditions(speed, radius, p.length, pair_compliance(p), p.viscosity, p.pressure_viscosity)
    return float(FILMS[name](load, at))


def _compute_similarity_sum(runs: Runs, name: str) -> float:
    """Scale U, G and W so that M = W U^-1/2 and L = G U^1/4 stay: then h* goes as U^(a - b/4 + c/2)."""
    load, radius, length, sigma = find_nose_contact(runs)
    p = runs.parameters("contact")
    one, two = (
        FILMS[name](
            load * f**0.5,
            Conditions(f, radius, length, sigma, p.viscosity, p.pressure_viscosity * f**-0.25),
        )
        for f in (1.0, math.e)
    )
    return math.log(two / one)


def compute_exponents(runs: Runs) -> Values:
    """The exponent of the load, and a - b/4 + c/2 of the exponents a of U, b of G, c of W."""
    load, radius, *_ = find_nose_contact(runs)
    of_load = {
        name: math.log(
            _compute_film(runs, name, 2.0 * load, 1.0, radius) / _compute_film(runs, name, load, 1.0, radius)
        )
        / math.log(2.0)
        for name in FILMS
        if name != "dry"
    }
    others = [value for name, value in of_load.items() if name != AS_PRINTED]
    return {
        "sum_printed": _compute_similarity_sum(runs, AS_PRINTED),
        "sum_negative": _compute_similarity_sum(runs, NEGATIVE),
        "sum_pan_hamrock": _compute_similarity_sum(runs, COMPARED),
        "of_load": of_load[AS_PRINTED], "least_other": min(others), "largest_other": max(others),
    }  # fmt: skip


def compare_films(runs: Runs) -> Values:
    """Films of (10) over another formula's, inside Table 3."""
    cycle = runs.kinematic()
    found: Values = {}
    inside = (cycle["contact.load_in_range"] > 0.0) & (cycle["contact.speed_in_range"] > 0.0)
    seen = (cycle["contact.load"], np.abs(cycle["camshaft.entraining_velocity"]),
            cycle["camshaft.radius_of_curvature"])  # fmt: skip
    for name, words in ((AS_PRINTED, "printed"), (NEGATIVE, "negative")):
        ratios = [
            _compute_film(runs, name, *one) / _compute_film(runs, COMPARED, *one)
            for one in zip(*(values[inside] for values in seen), strict=True)
        ]
        found |= {f"{words}_low": min(ratios), f"{words}_high": max(ratios)}
    return found


def check_table_3(runs: Runs) -> Values:
    """Shares of the cycle inside the ranges, and the squeeze-roll ratio, unbounded as u goes to zero."""
    cycle, p = runs.kinematic(), runs.parameters("contact")
    inside = {name: cycle[f"contact.{flag}_in_range"] for name, flag in TABLE_3_FLAGS.items()}
    u = np.abs(cycle["camshaft.entraining_velocity"])
    ratio = cycle.squeeze[u > 1e-9] / u[u > 1e-9]
    modulus = math.pi / pair_compliance(p)
    at = Conditions(1.0, 1.0, p.length, pair_compliance(p), p.viscosity, p.pressure_viscosity)
    return {
        "each": [f"{name} {100.0 * float(np.mean(flags[:-1])):.0f} %" for name, flags in inside.items()],
        "together": float(np.mean(np.prod(list(inside.values()), axis=0)[:-1])),
        "G": groups(modulus, 1.0, at).material,
        "ratio_low": ratio.min(), "ratio_high": ratio.max(),
    }  # fmt: skip


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
        found = _find_fixed_point(float(steady_film[n]), before, sign * squeeze_constant, speed * step)
        if found is None:
            failed.append(n)
            found = before
            if sign > 0.0:
                found = solve_implicit_step(float(steady_film[n]), before, squeeze_constant, speed * step)
        film.append(found)
    return FilmIteration(film, failed)


def _find_fixed_point(steady: float, before: float, constant: float, travel: float) -> float | None:
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


def _iterate_turn(runs: Runs, sign: float) -> FilmIteration:
    """K's own iteration over one kinematic turn; sign -1 is the printed (37)."""
    cycle = runs.kinematic()
    steady = np.interp(ANGLES_DEG, cycle.angle_deg, cycle["contact.steady_film_thickness"])
    velocity = np.array([runs.entraining(a) for a in ANGLES_DEG])
    step = 60.0 / KINEMATIC_SPEED / STEPS
    return iterate(steady, velocity, step, runs.parameters("contact").squeeze_constant, sign)


@cache
def run_iteration(runs: Runs) -> Values:
    """Where (37) to (39) do not converge, with either sign; and how the start is forgotten."""
    cycle = runs.kinematic()
    c, u = runs.parameters("contact").squeeze_constant, cycle["camshaft.entraining_velocity"][0]
    printed, right = _iterate_turn(runs, -1.0), _iterate_turn(runs, 1.0)
    away = np.abs(ANGLES_DEG[right.failed, None] - np.array(runs.reversals_deg)).min(axis=1)
    exact = np.interp(ANGLES_DEG, cycle.angle_deg, cycle.film)
    steady, step = float(cycle["contact.steady_film_thickness"][0]), 60.0 / KINEMATIC_SPEED / STEPS
    return {
        "steps": STEPS, "iterations": ITERATIONS,
        "failed_as_printed": len(printed.failed), "first_deg": ANGLES_DEG[printed.failed[0]],
        "growth_time": c * cycle.film[0] / u,
        "failed": len(right.failed), "away_deg": away.max(),
        "film_error": np.max(np.abs(np.array(right.film) - exact)[1:]),
        "first_velocity": (FIRST_INCREASE - 1.0) * steady / step,
        # The relaxation halves ln(h/h_ss) many times before the lift begins.
        "left_at_lift": math.log(FIRST_INCREASE) * math.exp(-u / (c * steady) * step * STEPS / 4.0),
    }  # fmt: skip
