"""What each formula is worth: a statement for every one, over the cam cycle and over Kushwaha's Table 3."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

import numpy as np

from models.quantities import Vector

from ..statement import Statement, met_if
from .cam import ratios
from .formulas import CENTRAL, FORMULAS, MINIMUM, Formula, in_table_3
from .runs import Runs
from .samples import Error, error_of

# A film that is right to this is right for any use; viscosity is hardly ever known better.
RIGHT = 0.10

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
    """Over all speeds, where the formula's conditions hold and where they do not."""
    inside, outside = (ratios(runs.cycles, formula, valid) for valid in (True, False))
    share = inside.size / (inside.size + outside.size)
    computed = (
        f"conditions hold in {100.0 * share:.0f} % of the event: {spread(inside)} times the numerical film"
    )
    if outside.size:
        computed += f"; elsewhere {spread(outside)}"
    values = {"share": share}
    for name, found in (("inside", inside), ("outside", outside)):
        if np.isfinite(found).any():
            values |= {f"{name}_low": float(np.nanmin(found)), f"{name}_high": float(np.nanmax(found))}
    return Statement(
        f"cycle-{formula.name}",
        formula.source,
        f"{formula.film} film h/R = {formula.text}",
        computed,
        met_if(_right(inside)),
        f"conditions: {formula.conditions}; met: within {100 * RIGHT:.0f} % there",
        values,
    )


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
    flags = np.concatenate([c.valid["kushwaha"] for c in runs.cycles])
    shares = {f"{c.speed_rpm:.0f}": float(np.mean(c.valid["kushwaha"])) for c in runs.cycles}
    words = ", ".join(f"{100.0 * share:.0f} % at {speed}" for speed, share in shares.items())
    return Statement(
        "table-3-share", "Kushwaha et al. 2000, Table 3", "The ranges of G, W and U hold through the cycle",
        f"in a part of the event only: {words} r/min", met_if(bool(flags.all())), "", shares,
    )  # fmt: skip


CHECKS: tuple[Check, ...] = (
    *(partial(in_the_cycle, formula) for formula in FORMULAS),
    table_3_in_the_cycle,
    *(partial(over_table_3, formula) for formula in FORMULAS if formula.valid is in_table_3),
    *(partial(power_law, film, blended) for film in (CENTRAL, MINIMUM) for blended in (False, True)),
)


def by_speed(runs: Runs) -> str:
    """A Markdown table: each formula over the numerical film at each speed, where valid and elsewhere."""
    speeds = [f"{c.speed_rpm:.0f} r/min" for c in runs.cycles]
    rows = [["Formula", "Film", "Conditions hold", *speeds], ["---"] * (3 + len(speeds))]
    for formula in FORMULAS:
        for valid, words in ((True, "yes"), (False, "no")):
            cells = [spread(ratios([c], formula, valid)) for c in runs.cycles]
            if set(cells) != {"nowhere"}:
                rows.append([formula.words, formula.film, words, *cells])
    return "\n".join("| " + " | ".join(row) + " |" for row in rows)
