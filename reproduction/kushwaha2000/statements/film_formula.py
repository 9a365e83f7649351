"""Sections 3 and 4.4: the film formula (10), its ranges, and the way to its squeeze velocity (37)-(39)."""

from __future__ import annotations

import math

import numpy as np

from models.contact.films import FILMS
from models.contact.films.groups import groups

from ...statement import Statement, Verdict, met_if
from ..film_iteration import FIRST_INCREASE, ITERATIONS, FilmIteration, iterate
from ..runs import AS_PRINTED, KINEMATIC_SPEED, NEGATIVE, Runs
from .check import Check
from .contact import at_nose, compliance

STEPS_PER_TURN = 500
HOURS_PER_STEP = (5.0, 7.0)
TABLE_3_FLAGS = {
    "G*": ("material", "5700 to 9650"),
    "w_s*": ("squeeze", "−0.005 to 0"),
    "W*": ("load", "0.34e-6 to 0.56e-5"),
    "U*": ("speed", "0.63e-11 to 3.3e-11"),
}
# A formula for the same central film, fitted to numerical solutions by others.
COMPARED = "pan_hamrock_central"


def _film(runs: Runs, name: str, load: float, speed: float, radius: float) -> float:
    p = runs.parameters("contact")
    return float(
        FILMS[name](load, speed, radius, p.length, compliance(runs), p.viscosity, p.pressure_viscosity)
    )


def time_per_step(runs: Runs) -> Statement:
    low, high = (hours * STEPS_PER_TURN / 24.0 for hours in HOURS_PER_STEP)
    return Statement(
        "time-per-step",
        "3",
        "A numerical EHL solution takes 5-7 h per time step, 500 steps per revolution",
        f"{low:.0f}-{high:.0f} days per revolution",
        Verdict.CANNOT,
        "a statement about the computers and methods of 1999; nothing here to measure it with",
        {"days_low": low, "days_high": high},
    )


def similarity(runs: Runs) -> Statement:
    """Exponents a of U, b of G, c of W of any power law: a - b/4 + c/2 = 1/2 (two-parameter similarity)."""
    sums = {name: _similarity_sum(runs, name) for name in (AS_PRINTED, NEGATIVE, COMPARED)}
    return Statement(
        "similarity",
        "(10)",
        "h* = 1.67 W*^0.059 U*^0.541 G*^0.421 exp(−96.775 w_s*)",
        f"a − b/4 + c/2 = {sums[AS_PRINTED]:.3f} as printed, {sums[NEGATIVE]:.3f} with −0.059, "
        f"{sums[COMPARED]:.3f} Pan and Hamrock; line contact similarity asks for 0.5",
        Verdict.NOT_MET,
        "an extrapolated regression, no similarity solution: no reference for accuracy",
        {"as_printed": sums[AS_PRINTED], "negative": sums[NEGATIVE], "pan_hamrock": sums[COMPARED]},
    )


def _similarity_sum(runs: Runs, name: str) -> float:
    """Scale U, G and W so that M = W U^-1/2 and L = G U^1/4 stay: then h* goes as U^(a - b/4 + c/2)."""
    load, radius, length, sigma = at_nose(runs)
    p = runs.parameters("contact")
    one, two = (
        FILMS[name](load * f**0.5, f, radius, length, sigma, p.viscosity, p.pressure_viscosity * f**-0.25)
        for f in (1.0, math.e)
    )
    return math.log(two / one)


def load_exponent(runs: Runs) -> Statement:
    load, radius, _, _ = at_nose(runs)
    exponents = {
        name: math.log(_film(runs, name, 2.0 * load, 1.0, radius) / _film(runs, name, load, 1.0, radius))
        / math.log(2.0)
        for name in FILMS
        if name != "dry"
    }
    others = [value for name, value in exponents.items() if name != AS_PRINTED]
    return Statement(
        "load-exponent",
        "(10)",
        "The film grows as W*^+0.059",
        f"exponent {exponents[AS_PRINTED]:+.3f}; all other line contact formulas {min(others):+.3f} to "
        f"{max(others):+.3f}",
        Verdict.NOT_MET,
        "a heavier load cannot thicken an EHL film; the sign is wrong, but see the size below",
        exponents,
    )


def film_size(runs: Runs) -> Statement:
    cycle = runs.kinematic()
    inside = (cycle["contact.load_in_range"] > 0.0) & (cycle["contact.speed_in_range"] > 0.0)
    ratios = {}
    for name in (AS_PRINTED, NEGATIVE):
        ratio = [
            _film(runs, name, load, abs(u), radius) / _film(runs, COMPARED, load, abs(u), radius)
            for load, u, radius in zip(
                cycle.load[inside],
                cycle["camshaft.entraining_velocity"][inside],
                cycle["camshaft.radius_of_curvature"][inside],
                strict=True,
            )
        ]
        ratios[name] = (min(ratio), max(ratio))
    return Statement(
        "film-size",
        "(10)",
        "The size of the film by (10)",
        f"over the part of the cycle inside Table 3, against Pan and Hamrock's central film: "
        f"{ratios[AS_PRINTED][0]:.2f}-{ratios[AS_PRINTED][1]:.2f} times with +0.059, "
        f"{ratios[NEGATIVE][0]:.1f}-{ratios[NEGATIVE][1]:.1f} times with −0.059",
        met_if(ratios[AS_PRINTED][0] > 0.5 and ratios[AS_PRINTED][1] < 2.0),
        "of the right size as printed only: the sign that physics wants makes the film several times too "
        "thick",
        {
            "printed_low": ratios[AS_PRINTED][0],
            "printed_high": ratios[AS_PRINTED][1],
            "negative_low": ratios[NEGATIVE][0],
            "negative_high": ratios[NEGATIVE][1],
        },
    )


def table_3(runs: Runs) -> Statement:
    cycle = runs.kinematic()
    shares = {name: cycle.share(f"contact.{flag}_in_range") for name, (flag, _) in TABLE_3_FLAGS.items()}
    together = np.prod([cycle[f"contact.{flag}_in_range"] for flag, _ in TABLE_3_FLAGS.values()], axis=0)
    every = float(np.mean(together[:-1]))
    p = runs.parameters("contact")
    material = groups(
        math.pi / compliance(runs), 1.0, 1.0, 1.0, p.length, p.viscosity, p.pressure_viscosity
    ).material
    parts = ", ".join(f"{name} {100.0 * share:.0f} %" for name, share in shares.items())
    return Statement(
        "table-3",
        "Table 3",
        "(10) applies inside the table's ranges of G*, w_s*, W* and U*",
        f"share of the cycle inside at 1000 r/min: {parts}; all four {100 * every:.0f} % (G* = "
        f"{material:.0f})",
        met_if(every == 1.0),
        "the source applies (10) over the whole cycle, also where u = 0 and U* = 0",
        {**{f"share_{TABLE_3_FLAGS[k][0]}": v for k, v in shares.items()}, "share_all": every, "G": material},
    )


def squeeze_ratio(runs: Runs) -> Statement:
    """w_s = (dh/dt)/u: unbounded as u goes to zero."""
    cycle = runs.kinematic()
    u = np.abs(cycle["camshaft.entraining_velocity"])
    moving = u > 1e-9
    ratio = cycle.squeeze[moving] / u[moving]
    return Statement(
        "squeeze-ratio",
        "Table 3",
        "The squeeze-roll ratio w_s* lies between −0.005 and 0",
        f"{ratio.min():.2g} to {ratio.max():.2g} at 1000 r/min: (10) demands ln(h_ss/h)/96.775, "
        "which has no bound at the reversals, and is positive in separation",
        Verdict.CANNOT,
        "a film that both falls and recovers in every cycle needs both signs",
        {"lowest": float(ratio.min()), "highest": float(ratio.max())},
    )


def iteration(runs: Runs, sign: float) -> FilmIteration:
    """K's own iteration over one kinematic turn in 500 steps; sign -1 is the printed (37)."""
    cycle = runs.kinematic()
    angles = np.arange(STEPS_PER_TURN + 1) * (360.0 / STEPS_PER_TURN)
    steady = np.interp(angles, cycle.angle_deg, cycle["contact.steady_film_thickness"])
    velocity = np.array([runs.entraining(a) for a in angles])
    step = 60.0 / KINEMATIC_SPEED / STEPS_PER_TURN
    return iterate(steady, velocity, step, runs.parameters("contact").squeeze_constant, sign)


def squeeze_sign(runs: Runs) -> Statement:
    failed = iteration(runs, -1.0).failed
    cycle = runs.kinematic()
    c = runs.parameters("contact").squeeze_constant
    first = c * cycle.film[0] / cycle["camshaft.entraining_velocity"][0]
    return Statement(
        "squeeze-sign",
        "(37)",
        "∂h/∂t = (h_{n−1} − h_n)/Δt, positive in separation",
        f"dh/dt = +(|u|/96.775) ln(h/h_ss): a disturbance grows by e in {1e6 * first:.0f} µs on the base "
        "circle; the "
        f"iteration fails in {len(failed)} of {STEPS_PER_TURN} steps, first at {_degrees(failed[0])}",
        Verdict.CANNOT,
        "the sign contradicts the text and makes the film unstable; (h_n − h_{n−1})/Δt is stable",
        {"failed_steps": len(failed), "growth_time_s": float(first)},
    )


def own_iteration(runs: Runs) -> Statement:
    result = iteration(runs, 1.0)
    cycle = runs.kinematic()
    exact = np.interp(np.arange(STEPS_PER_TURN + 1) * (360.0 / STEPS_PER_TURN), cycle.angle_deg, cycle.film)
    off = float(np.max(np.abs(np.array(result.film) - exact)[1:]))
    failed = len(result.failed)
    return Statement(
        "own-iteration",
        "(37)-(39)",
        "The film thickness and squeeze velocity are obtained at each time step",
        f"with the right sign {failed} of {STEPS_PER_TURN} steps do not converge in {ITERATIONS} "
        "iterations, all "
        f"within {_spread(runs, result):.1f}° of a reversal",
        met_if(failed == 0),
        "near u = 0 the fixed point repels; the same equation, read as a differential equation, is "
        "well-posed. "
        f"Even solved exactly, 500 steps leave an error of {1e6 * off:.3f} µm there",
        {"failed_steps": failed, "film_error_m": off},
    )


def _degrees(step: int) -> str:
    return f"{360.0 * step / STEPS_PER_TURN:.1f}°"


def _spread(runs: Runs, result: FilmIteration) -> float:
    """Largest distance of a failed step from a reversal (deg)."""
    return max(
        min(abs(360.0 * n / STEPS_PER_TURN - angle) for angle in runs.reversals_deg) for n in result.failed
    )


def first_increase(runs: Runs) -> Statement:
    """The start is forgotten: the relaxation halves ln(h/h_ss) many times before the lift begins."""
    cycle = runs.kinematic()
    c, u = runs.parameters("contact").squeeze_constant, cycle["camshaft.entraining_velocity"][0]
    step = 60.0 / KINEMATIC_SPEED / STEPS_PER_TURN
    steady = float(cycle["contact.steady_film_thickness"][0])
    left = math.log(FIRST_INCREASE) * math.exp(-u / (c * steady) * step * STEPS_PER_TURN / 4.0)
    first = (FIRST_INCREASE - 1.0) * steady / step
    return Statement(
        "first-increase",
        "(39)",
        "The film is first increased by 5 per cent, merely for a first squeeze velocity",
        f"{1e3 * first:.3f} mm/s in the first step; a film 5 % off is {left:.0e} off after the 90° to the "
        "lift",
        met_if(left < 1e-6),
        "",
        {"first_squeeze_velocity": first, "left_at_lift": left},
    )


BEFORE: tuple[Check, ...] = (time_per_step, similarity, load_exponent, film_size, table_3, squeeze_ratio)
EQUATIONS: tuple[Check, ...] = (squeeze_sign, own_iteration, first_increase)
