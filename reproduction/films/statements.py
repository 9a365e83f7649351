"""What each formula is worth: a statement for every one, over the cam cycle and over Kushwaha's Table 3."""

from functools import cache, partial

import numpy as np

from models.core.quantities import Vector

from ..statement import Claim, Values
from .cam import SQUEEZED, STEADY
from .formulas import CENTRAL, FORMULAS, MINIMUM, Formula, is_in_table_3
from .runs import Runs

# A film with this relative error is right for any use: viscosity is hardly known better.
RIGHT = 0.10
# A fifth of RIGHT: an error that does not decide which formula is right.
NOT_SEEN = 0.02


def summarise_ratios(name: str, values: Vector) -> Values:
    """Least, largest and median of some ratios, whether all are right, and words for them."""
    values = values[np.isfinite(values)]
    if not values.size:
        return {name: "nowhere", f"{name}_right": False}
    low, high, median = values.min(), values.max(), np.median(values)
    return {
        name: f"{low:.2f}-{high:.2f} (median {median:.2f})",
        f"{name}_low": low, f"{name}_high": high, f"{name}_median": median,
        f"{name}_right": np.max(np.abs(values - 1.0)) <= RIGHT,
    }  # fmt: skip


def measure_near_share(ratio: Vector) -> float:
    """Share within RIGHT of 1."""
    return float(np.mean(np.abs(ratio - 1.0) <= RIGHT))


@cache
def judge_in_cycle(runs: Runs, formula: Formula) -> Values:
    """Against the steady film that it is for, where its conditions hold and where they do not; and against
    the transient film."""
    steady, transient = runs.over_steady(formula.name), runs.ratios(formula.name)
    valid = runs.valid(formula.name)
    found = summarise_ratios("inside", steady[valid]) | summarise_ratios("outside", steady[~valid])
    found["elsewhere"] = f"; elsewhere {found['outside']}" if "outside_low" in found else ""
    return found | {
        "share": np.mean(valid),
        "median": np.median(transient),
        "near": measure_near_share(transient),
    }


@cache
def judge_squeezed(runs: Runs, formula: Formula) -> Values:
    """With the squeeze term, against the transient film."""
    name = f"{formula.name} {SQUEEZED}"
    ratio, valid = runs.ratios(name), runs.valid(name)
    at_rest = np.concatenate([c.ratio(name)[c.reversals] for c in runs.cycles])
    parts = {"all": ratio, "inside": ratio[valid], "outside": ratio[~valid], "at_rest": at_rest}
    found: Values = {"share": np.mean(valid)}
    for part, values in parts.items():
        found |= summarise_ratios(part, values)
    return found


@cache
def compare_steady(runs: Runs) -> Values:
    """Whether the film is the steady one of each instant's load, speed and radius."""
    shares = {c.speed_rpm: measure_near_share(c.ratio(f"{STEADY} {CENTRAL}")) for c in runs.cycles}
    kept = np.concatenate([c.transient[MINIMUM][c.reversals] for c in runs.cycles])
    return {
        "each": [f"{100.0 * share:.0f} % at {speed:.0f}" for speed, share in shares.items()],
        "least": min(shares.values()), "most": max(shares.values()),
        "kept_low": kept.min(), "kept_high": kept.max(),
    }  # fmt: skip


def measure_resolution(runs: Runs) -> Values:
    """The transient film's error, by half as many nodes."""
    inside = runs.shown.in_event
    histories = (runs.coarser, runs.shown.history)
    central, minimum = (
        [getattr(history, name)[inside] for history in histories]
        for name in ("film_thickness", "minimum_film_thickness")
    )
    return {
        "coarse": histories[0].x.shape[1], "fine": histories[1].x.shape[1],
        "central": np.max(np.abs(central[0] / central[1] - 1.0)),
        "minimum": np.max(np.abs(minimum[0] / minimum[1] - 1.0)),
        "pressures": [np.max(history.maximum_pressure[inside]) for history in histories],
    }  # fmt: skip


@cache
def measure_table_3_share(runs: Runs) -> Values:
    """How much of the cam's event is inside Table 3."""
    shares = {c.speed_rpm: np.mean(c.judged["kushwaha"].valid) for c in runs.cycles}
    each = [f"{100.0 * share:.0f} % at {speed:.0f}" for speed, share in shares.items()]
    return {"each": each, "least": min(shares.values())}


@cache
def judge_over_table_3(runs: Runs, formula: Formula) -> Values:
    """Kushwaha's formula where he says it applies."""
    s = runs.sample
    found = summarise_ratios("steady", s.over_numerical(formula))
    found |= summarise_ratios("squeezed", s.squeezed_over_numerical(formula))
    return found | {"M_low": s.M.min(), "M_high": s.M.max(), "L_low": s.L.min(), "L_high": s.L.max()}


OF_TABLE_3 = [formula for formula in FORMULAS if formula.valid is is_in_table_3]
CYCLE = [
    Claim[Runs](
        f"cycle-{formula.name}", formula.source, f"{formula.film} film h/R = {formula.text}",
        partial(judge_in_cycle, formula=formula),
        "conditions hold in {share:.0f%} of the event: {inside} times the steady numerical film{elsewhere}; "
        "{median:.2f} times the transient film in the median, within 10 % of it in {near:.0f%} of the event",
        lambda v: v.inside_right,
        f"conditions: {formula.conditions}; met: within 10 % of the steady film there",
    )
    for formula in FORMULAS
]  # fmt: skip
SQUEEZED_CYCLE = [
    Claim[Runs](
        f"cycle-{formula.name}-{SQUEEZED}", formula.source,
        f"{formula.film} film h/R = {formula.text} exp(−96.775 w_s)",
        partial(judge_squeezed, formula=formula),
        "conditions hold in {share:.0f%} of the event: {inside} times the transient film; elsewhere "
        "{outside}; at the reversals {at_rest}",
        lambda v: v.inside_right, f"conditions: {formula.conditions}, w_s too; met: within 10 % there",
    )
    for formula in OF_TABLE_3
]  # fmt: skip
TABLE_3 = [
    Claim[Runs](
        f"table-3-{formula.name}", "Kushwaha et al. 2000, Table 3",
        f"central film h/R = {formula.text} over its ranges", partial(judge_over_table_3, formula=formula),
        "steady {steady} times the numerical film, with squeeze {squeezed}",
        lambda v: v.steady_right and v.squeezed_right,
        "the ranges are M = {M_low:.2f}-{M_high:.1f}, L = {L_low:.0f}-{L_high:.0f}: lightly loaded, much of "
        "it not elastohydrodynamic",
    )
    for formula in OF_TABLE_3
]  # fmt: skip
CLAIMS: tuple[Claim[Runs], ...] = (
    *CYCLE,
    Claim("cycle-steady", "every formula without squeeze",
        "The film through the cycle is the steady one of each instant", compare_steady,
        "central film within 10 % of it in {each} r/min; at the reversals, where the steady film is 0, the "
        "minimum is {kept_low:µ.3f}-{kept_high:µ.3f} µm",
        lambda v: v.least == 1.0, "squeezing keeps the film up where entrainment reverses"),
    Claim("cycle-resolution", "transient numerical film",
        "The film through the cycle does not depend on the number of nodes (1000 r/min)", measure_resolution,
        "from {coarse} to {fine} nodes central films change by up to {central:.1f%}, minimum films by "
        "{minimum:.1f%}; the highest pressure from {pressures[0]:G.2f} to {pressures[1]:G.2f} GPa",
        lambda v: max(v.central, v.minimum) <= NOT_SEEN,
        "met: films within 2 %; of an error of second order a third of this is left"),
    *SQUEEZED_CYCLE,
    Claim("table-3-share", "Kushwaha et al. 2000, Table 3",
        "The ranges of G, W and U hold through the cycle", measure_table_3_share,
        "in a part of the event only: {each} r/min", lambda v: v.least == 1.0),
    *TABLE_3,
)  # fmt: skip
