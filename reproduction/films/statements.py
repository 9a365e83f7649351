"""What each formula is worth: a statement for every one, over the cam cycle and over Kushwaha's Table 3."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

import numpy as np

from models.quantities import Vector

from ..statement import Statement, met_if
from .cam import SQUEEZED, STEADY
from .formulas import CENTRAL, FORMULAS, MINIMUM, Formula, in_table_3
from .runs import Runs
from .samples import Error, error_of

# A film that is right to this is right for any use; viscosity is hardly ever known better.
RIGHT = 0.10
# A fifth of the least that separates the formulas that are right.
NOT_SEEN = 0.02

Check = Callable[[Runs], Statement]


def spread(values: Vector) -> str:
    """Least, median and largest of some ratios."""
    values = values[np.isfinite(values)]
    if not values.size:
        return "nowhere"
    return f"{values.min():.2f}-{values.max():.2f} (median {np.median(values):.2f})"


def _right(values: Vector) -> bool:
    values = values[np.isfinite(values)]
    return bool(values.size and np.max(np.abs(values - 1.0)) <= RIGHT)


def in_the_cycle(formula: Formula, runs: Runs) -> Statement:
    """Against the steady film that it is for, where its conditions hold and where they do not; and against
    the transient film."""
    steady = runs.over_steady(formula.name)
    valid = runs.valid(formula.name)
    inside, outside = steady[valid], steady[~valid]
    transient = runs.ratios(formula.name)
    share = float(np.mean(valid))
    computed = (
        f"conditions hold in {100.0 * share:.0f} % of the event: {spread(inside)} times the steady numerical "
        "film"
    )
    if np.isfinite(outside).any():
        computed += f"; elsewhere {spread(outside)}"
    computed += f"; {_of_the_transient(transient)}"
    values = {"share": share, "transient_median": float(np.median(transient)), "near": near_share(transient)}
    for name, found in (("inside", inside), ("outside", outside)):
        if np.isfinite(found).any():
            values |= {f"{name}_low": float(np.nanmin(found)), f"{name}_high": float(np.nanmax(found))}
    return Statement(
        f"cycle-{formula.name}",
        formula.source,
        f"{formula.film} film h/R = {formula.text}",
        computed,
        met_if(_right(inside)),
        f"conditions: {formula.conditions}; met: within {100 * RIGHT:.0f} % of the steady film there",
        values,
    )


def near_share(ratio: Vector) -> float:
    """Share within RIGHT of 1."""
    return float(np.mean(np.abs(ratio - 1.0) <= RIGHT))


def _of_the_transient(ratio: Vector) -> str:
    return (
        f"{np.median(ratio):.2f} times the transient film in the median, within {100 * RIGHT:.0f} % of it in "
        f"{100.0 * near_share(ratio):.0f} % of the event"
    )


def squeezed_in_the_cycle(formula: Formula, runs: Runs) -> Statement:
    """Kushwaha's formula with its squeeze term against the transient film."""
    name = f"{formula.name} {SQUEEZED}"
    ratio, valid = runs.ratios(name), runs.valid(name)
    at_rest = np.concatenate([c.ratio(name)[c.reversals] for c in runs.cycles])
    share = float(np.mean(valid))
    return Statement(
        f"cycle-{formula.name}-{SQUEEZED}",
        formula.source,
        f"{formula.film} film h/R = {formula.text} exp(−96.775 w_s)",
        f"conditions hold in {100.0 * share:.0f} % of the event: {spread(ratio[valid])} times the transient "
        f"film; elsewhere {spread(ratio[~valid])}; at the reversals {spread(at_rest)}",
        met_if(_right(ratio[valid])),
        f"conditions: {formula.conditions}, w_s too; met: within {100 * RIGHT:.0f} % there",
        {"share": share, "at_rest_low": float(at_rest.min()), "at_rest_high": float(at_rest.max()),
         "low": float(ratio.min()), "high": float(ratio.max())},
    )  # fmt: skip


def steady_for_transient(runs: Runs) -> Statement:
    """Whether the film is the one that load, speed and radius would keep up."""
    shares = {f"{c.speed_rpm:.0f}": near_share(c.ratio(f"{STEADY} {CENTRAL}")) for c in runs.cycles}
    kept = np.concatenate([c.transient[MINIMUM][c.reversals] for c in runs.cycles])
    words = ", ".join(f"{100.0 * share:.0f} % at {speed}" for speed, share in shares.items())
    return Statement(
        "cycle-steady", "every formula without squeeze",
        "The film through the cycle is the steady one of each instant",
        f"central film within {100 * RIGHT:.0f} % of it in {words} r/min; at the reversals, where the steady "
        f"film is 0, the minimum is {1e6 * kept.min():.3f}-{1e6 * kept.max():.3f} µm",
        met_if(min(shares.values()) == 1.0), "squeezing keeps the film up where entrainment reverses",
        {**shares, "kept_low": float(kept.min()), "kept_high": float(kept.max())},
    )  # fmt: skip


def resolution(runs: Runs) -> Statement:
    """The transient film's error, by half as many nodes."""
    fine, coarse = runs.shown.history, runs.coarser
    inside = runs.shown.in_event
    change = {
        film: float(np.max(np.abs(a[inside] / b[inside] - 1.0)))
        for film, a, b in (
            (CENTRAL, coarse.film_thickness, fine.film_thickness),
            (MINIMUM, coarse.minimum_film_thickness, fine.minimum_film_thickness),
        )
    }
    highest = [float(np.max(h.maximum_pressure[inside])) for h in (coarse, fine)]
    nodes = [h.x.shape[1] for h in (coarse, fine)]
    return Statement(
        "cycle-resolution", "transient numerical film",
        f"The film through the cycle does not depend on the number of nodes "
        f"({runs.shown.speed_rpm:.0f} r/min)",
        f"from {nodes[0]} to {nodes[1]} nodes central films change by up to {100.0 * change[CENTRAL]:.1f} %, "
        f"minimum films by {100.0 * change[MINIMUM]:.1f} %; the highest pressure from "
        f"{1e-9 * highest[0]:.2f} to {1e-9 * highest[1]:.2f} GPa",
        met_if(max(change.values()) <= NOT_SEEN),
        f"met: films within {100 * NOT_SEEN:.0f} %; of an error of second order a third of this is left",
        {"central": change[CENTRAL], "minimum": change[MINIMUM], "coarse_pressure": highest[0],
         "fine_pressure": highest[1]},
    )  # fmt: skip


def over_table_3(formula: Formula, runs: Runs) -> Statement:
    """Kushwaha's formula where he says it applies."""
    steady, squeezed = runs.fit.over_numerical(formula), runs.fit.squeezed_over_numerical(formula)
    values = {"steady_low": np.nanmin(steady), "steady_high": np.nanmax(steady),
              "steady_median": np.nanmedian(steady), "squeezed_low": np.nanmin(squeezed),
              "squeezed_high": np.nanmax(squeezed), "squeezed_median": np.nanmedian(squeezed)}  # fmt: skip
    M, L = runs.fit.M, runs.fit.L
    return Statement(
        f"table-3-{formula.name}",
        "Kushwaha et al. 2000, Table 3",
        f"central film h/R = {formula.text} over its ranges",
        f"steady {spread(steady)} times the numerical film, with squeeze {spread(squeezed)}",
        met_if(_right(steady) and _right(squeezed)),
        f"the ranges are M = {M.min():.2f}-{M.max():.1f}, L = {L.min():.0f}-{L.max():.0f}: lightly loaded, "
        "much of it not elastohydrodynamic",
        {name: float(value) for name, value in values.items()},
    )


def power_law(film: str, blended: bool, runs: Runs) -> Statement:
    """The new regression, judged by contacts that it was not fitted to."""
    law = runs.laws[film, blended]
    own, steady, squeezed = (
        error_of(law, s, squeezed)
        for s, squeezed in ((runs.fit, False), (runs.validation, False), (runs.validation, True))
    )
    return Statement(
        f"new-{film}{'-joined' if blended else ''}",
        "new regression",
        f"{film} film h/R = {law.text}; with squeeze times exp(−{law.squeeze_constant:.3f} w_s U^−1/4)",
        f"steady {_words(steady)} (where it was fitted {_words(own)}); with squeeze {_words(squeezed)}",
        met_if(steady.worst <= RIGHT),
        "U, G, W with E' = 2/compliance; a − b/4 + c/2 = 1/2 by construction; an interpolation over Table 3, "
        "not for other contacts",
        {"constant": law.constant, "speed": law.speed, "material": law.material, "load": law.load,
         "squeeze": law.squeeze_constant, "blend": law.blend, "rms": steady.rms, "worst": steady.worst,
         "fit_rms": own.rms, "squeezed_rms": squeezed.rms, "squeezed_worst": squeezed.worst},
    )  # fmt: skip


def _words(error: Error) -> str:
    return f"rms {100.0 * error.rms:.1f} %, at most {100.0 * error.worst:.1f} %"


def table_3_in_the_cycle(runs: Runs) -> Statement:
    """How much of the cam's event is inside Table 3."""
    flags = np.concatenate([c.judged["kushwaha"].valid for c in runs.cycles])
    shares = {f"{c.speed_rpm:.0f}": float(np.mean(c.judged["kushwaha"].valid)) for c in runs.cycles}
    words = ", ".join(f"{100.0 * share:.0f} % at {speed}" for speed, share in shares.items())
    return Statement(
        "table-3-share", "Kushwaha et al. 2000, Table 3", "The ranges of G, W and U hold through the cycle",
        f"in a part of the event only: {words} r/min", met_if(bool(flags.all())), "", shares,
    )  # fmt: skip


CHECKS: tuple[Check, ...] = (
    *(partial(in_the_cycle, formula) for formula in FORMULAS),
    steady_for_transient,
    resolution,
    *(partial(squeezed_in_the_cycle, formula) for formula in FORMULAS if formula.valid is in_table_3),
    table_3_in_the_cycle,
    *(partial(over_table_3, formula) for formula in FORMULAS if formula.valid is in_table_3),
    *(partial(power_law, film, blended) for film in (CENTRAL, MINIMUM) for blended in (False, True)),
)
