"""The page's text with its numbers: what the verdicts amount to, films by speed."""

from collections.abc import Callable
from types import SimpleNamespace
from typing import Any

import numpy as np

from models.core.quantities import Vector

from ..kushwaha2000.runs import NOSE_DEG
from ..publication import format_bullets, format_table
from ..statement import Numbers, format_numbers
from .cam import CamCycle
from .formulas import CENTRAL, FORMULAS, MINIMUM
from .runs import Runs
from .statements import CLAIMS, judge_in_cycle

MICRO = 1e6
# A power law, for whose conditions all stand.
POWER_LAW = "pan_hamrock_central"
# What the sentences take from statements.
NAMES = {
    "printed": "cycle-kushwaha", "negative": "cycle-kushwaha_negative", "shares": "table-3-share",
    "table": "table-3-kushwaha", "table_negative": "table-3-kushwaha_negative",
    "toyoda": "cycle-dowson_toyoda", "pan": f"cycle-{POWER_LAW}", "steady": "cycle-steady",
    "squeezed": "cycle-kushwaha-squeezed",
}  # fmt: skip
SENTENCES = (
    "Kushwaha's (10) as printed (+0.059) is {printed.inside_low:.2f}-{printed.inside_high:.2f} times the "
    "steady numerical central film in the part of the event inside Table 3 ({shares.each} r/min), and up to "
    "{printed.outside_high:.1f} times outside. With −0.059 it is "
    "{negative.inside_low:.2f}-{negative.inside_high:.2f} times inside, and up to "
    "{negative.outside_high:.1f} times outside.",
    "Over all of Table 3 the printed formula gives {table.steady_low:.2f}-{table.steady_high:.2f} times the "
    "numerical film (median {table.steady_median:.2f}): it does not fall as 1/W between nearly rigid "
    "bodies. The other sign gives {table_negative.steady_low:.2f}-{table_negative.steady_high:.2f}. With "
    "squeeze they give {table.squeezed_low:.2f}-{table.squeezed_high:.2f} and "
    "{table_negative.squeezed_low:.2f}-{table_negative.squeezed_high:.2f}.",
    "In {laws.outside:.0f%} of the event the contact is not elastic-piezoviscous, the condition of power "
    "laws: {laws.on_flanks:.0f%} of that on the flanks, and at the nose at {laws.nose} r/min. There "
    "Dowson-Toyoda is up to {toyoda.outside_high:.2f} and Pan-Hamrock up to {pan.outside_high:.2f} times "
    "the steady central film; inside they are {toyoda.inside_low:.2f}-{toyoda.inside_high:.2f} and "
    "{pan.inside_low:.2f}-{pan.inside_high:.2f}. Formulas for the minimum film also hold outside: "
    "{laws.minimum} everywhere.",
    "No steady film describes the cam contact. It is within 10 % of the transient film in "
    "{steady.least:.0f%} to {steady.most:.0f%} of the event, and 0 at the reversals, where the transient "
    "minimum is {steady.kept_low:µ.2f}-{steady.kept_high:µ.2f} µm. With its squeeze term the printed "
    "formula gives {squeezed.at_rest_low:.2f}-{squeezed.at_rest_high:.2f} times the central film there, and "
    "{squeezed.all_low:.2f}-{squeezed.all_high:.1f} times over the event.",
)


def summarise(runs: Runs) -> str:
    """A Markdown list."""
    quantities = {claim.key: claim.quantity for claim in CLAIMS}
    found: dict[str, Any] = {name: Numbers(quantities[key](runs)) for name, key in NAMES.items()}
    found["laws"] = _measure_conditions(runs)
    return format_bullets(format_numbers(text, SimpleNamespace(**found)) for text in SENTENCES)


def _measure_conditions(runs: Runs) -> SimpleNamespace:
    """Where the conditions of power laws do not hold, and how right minimum films are everywhere."""
    outside = [~c.judged[POWER_LAW].valid for c in runs.cycles]
    flanks = [
        (c.angle_deg < min(c.reversals_deg)) | (c.angle_deg > max(c.reversals_deg)) for c in runs.cycles
    ]
    nose = [f"{c.speed_rpm:.0f}" for c, out in zip(runs.cycles, outside, strict=True) if out[c.at(NOSE_DEG)]]
    minimum = []
    for formula in FORMULAS:
        if formula.film == MINIMUM:
            v = judge_in_cycle(runs, formula)
            low, high = min(v["inside_low"], v.get("outside_low", np.inf)), v.get("outside_high", 0.0)
            minimum.append(f"{formula.label} {low:.2f}-{max(v['inside_high'], high):.2f}")
    return SimpleNamespace(
        outside=np.mean(np.concatenate(outside)),
        on_flanks=np.mean(np.concatenate(flanks)[np.concatenate(outside)]),
        nose=", ".join(nose) or "no",
        minimum=minimum,
    )


def format_speeds(runs: Runs) -> str:
    """A Markdown table: the transient film, then each other film over it, in a column for each speed."""
    speeds = [f"{c.speed_rpm:.0f} r/min" for c in runs.cycles]
    rows = [[words, film, *(cell(c) for c in runs.cycles)] for words, film, cell in NUMBERS]
    for name, judged in runs.cycles[0].judged.items():
        ratios = (format_ratio(c, name) for c in runs.cycles)
        rows.append([f"{judged.label} / transient", judged.film, *ratios])
    return format_table(["", "Film", *speeds], *rows)


def format_ratio(c: CamCycle, name: str) -> str:
    """Ratio at the nose; median over the event; at the reversals; share outside the conditions."""
    ratio, outside = c.ratio(name), 100.0 * float(np.mean(~c.judged[name].valid))
    at_rest = format_span(ratio[c.reversals])
    return f"{ratio[c.at(NOSE_DEG)]:.2f}; {np.nanmedian(ratio):.2f}; {at_rest}; {outside:.0f} %"


def format_span(values: Vector) -> str:
    """Least and largest, 0 where no film is steady."""
    low, high = (float(f(np.nan_to_num(values))) for f in (np.min, np.max))
    return "0" if high < 0.005 else f"{low:.2f}-{high:.2f}"


NUMBERS: tuple[tuple[str, str, Callable[[CamCycle], str]], ...] = (
    ("transient numerical, at the nose [µm]", CENTRAL, lambda c: _format_nose(c, CENTRAL)),
    ("the same", MINIMUM, lambda c: _format_nose(c, MINIMUM)),
    ("at the four reversals [µm]", MINIMUM,
     lambda c: ", ".join(f"{MICRO * c.transient[MINIMUM][k]:.3f}" for k in c.reversals)),
    ("least of the event [µm], cam angle", MINIMUM,
     lambda c: f"{MICRO * c.least[0]:.3f} at {c.least[1]:.1f}°"),
    ("Moes' M; L away from the reversals", "",
     lambda c: f"{np.nanmin(c.M):.1f}-{np.nanmax(c.M):.0f}; {np.nanmin(c.L):.0f}-{np.nanmax(c.L):.0f}"),
)  # fmt: skip


def _format_nose(c: CamCycle, film: str) -> str:
    return f"{MICRO * c.transient[film][c.at(NOSE_DEG)]:.3f}"
