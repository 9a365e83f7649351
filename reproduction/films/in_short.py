"""What the verdicts amount to, in a few sentences with their numbers."""

from __future__ import annotations

import textwrap
from collections.abc import Mapping, Sequence

import numpy as np

from ..kushwaha2000.runs import NOSE_DEG
from ..statement import Statement
from .cam import SQUEEZED
from .formulas import FORMULAS, MINIMUM
from .runs import Runs

Values = Mapping[str, float]
# A power law, for whose conditions all stand.
POWER_LAW = "pan_hamrock_central"


def bullets(sentences: Sequence[str]) -> str:
    """A Markdown list."""
    return "".join(
        textwrap.fill(text, 110, initial_indent="- ", subsequent_indent="  ") + "\n" for text in sentences
    )


def in_short(runs: Runs, statements: Sequence[Statement]) -> str:
    """A Markdown list."""
    found = {s.key: s.values for s in statements}
    return bullets(
        [_kushwaha(found), _table_3(found), _power_laws(found, runs), _transient(found), _regression(found)]
    )


def _kushwaha(found: Mapping[str, Values]) -> str:
    printed, other = (found[f"cycle-{name}"] for name in ("kushwaha", "kushwaha_negative"))
    shares = ", ".join(f"{_percent(share)} at {speed}" for speed, share in found["table-3-share"].items())
    return (
        f"Kushwaha's (10) as printed (+0.059) is {_inside(printed)} times the steady numerical central film "
        f"where Table 3 holds in the event ({shares} r/min), up to {printed['outside_high']:.1f} elsewhere; "
        f"with −0.059 it is {_inside(other)}, and up to {other['outside_high']:.1f}."
    )


def _table_3(found: Mapping[str, Values]) -> str:
    printed, other = (found[f"table-3-{name}"] for name in ("kushwaha", "kushwaha_negative"))
    steady, squeezed = (
        [f"{v[f'{state}_low']:.2f}-{v[f'{state}_high']:.2f}" for v in (printed, other)]
        for state in ("steady", "squeezed")
    )
    return (
        f"Over all of Table 3 the printed one is {steady[0]} times (median {printed['steady_median']:.2f}): "
        f"it misses that films between nearly rigid bodies fall as 1/W. The other sign: {steady[1]}. With "
        f"squeeze {squeezed[0]} and {squeezed[1]}."
    )


def _power_laws(found: Mapping[str, Values], runs: Runs) -> str:
    toyoda, pan = (found[f"cycle-{name}"] for name in ("dowson_toyoda", POWER_LAW))
    outside = [~c.judged[POWER_LAW].valid for c in runs.cycles]
    flanks = [
        (c.angle_deg < min(c.reversals_deg)) | (c.angle_deg > max(c.reversals_deg)) for c in runs.cycles
    ]
    on_flanks = float(np.mean(np.concatenate(flanks)[np.concatenate(outside)]))
    nose = [f"{c.speed_rpm:.0f}" for c, out in zip(runs.cycles, outside, strict=True) if out[c.at(NOSE_DEG)]]
    minimum = ", ".join(
        f"{formula.words} {_anywhere(found[f'cycle-{formula.name}'])}"
        for formula in FORMULAS
        if formula.film == MINIMUM
    )
    return (
        f"{_percent(1.0 - pan['share'])} of the event is outside the conditions of power laws: "
        f"{_percent(on_flanks)} of that on the flanks, at the nose at {', '.join(nose) or 'no'} r/min. There "
        f"Dowson-Toyoda is up to {toyoda['outside_high']:.2f}, Pan-Hamrock up to {pan['outside_high']:.2f} "
        f"times the steady central film; inside {_inside(toyoda)} and {_inside(pan)}. Minimum films are "
        f"better than their conditions: {minimum} everywhere."
    )


def _transient(found: Mapping[str, Values]) -> str:
    shares = dict(found["cycle-steady"])
    low, high = shares.pop("kept_low"), shares.pop("kept_high")
    squeezed = found[f"cycle-kushwaha-{SQUEEZED}"]
    return (
        f"No steady film is the cam's: it is within 10 % of the transient one in "
        f"{_percent(min(shares.values()))} to {_percent(max(shares.values()))} of the event, and 0 at the "
        f"reversals, where the transient minimum is {1e6 * low:.2f}-{1e6 * high:.2f} µm. With its squeeze "
        f"term the printed formula keeps {squeezed['at_rest_low']:.2f}-{squeezed['at_rest_high']:.2f} times "
        f"the central film there; over the event it is {squeezed['low']:.2f}-{squeezed['high']:.1f} times it."
    )


def _regression(found: Mapping[str, Values]) -> str:
    laws = [found[f"new-{name}"] for name in ("central", "minimum")]
    joined = [found[f"new-{name}-joined"] for name in ("central", "minimum")]
    return (
        f"No power law has Table 3: the best is right to {_both(laws, 'rms')} rms, {_both(laws, 'worst')} at "
        f"most (central and minimum film). Joined with Martin's film, 4.9 U/W, to {_both(joined, 'rms')} "
        f"rms, {_both(joined, 'worst')} at most, on contacts that it was not fitted to; with squeeze in its "
        f"group w_s U^-1/4 to {_both(joined, 'squeezed_rms')} rms, {_both(joined, 'squeezed_worst')} at most."
    )


def _inside(values: Values) -> str:
    return f"{values['inside_low']:.2f}-{values['inside_high']:.2f}"


def _anywhere(v: Values) -> str:
    low = min(v["inside_low"], v.get("outside_low", v["inside_low"]))
    return f"{low:.2f}-{max(v['inside_high'], v.get('outside_high', v['inside_high'])):.2f}"


def _percent(share: float) -> str:
    return f"{100.0 * share:.0f} %"


def _both(values: Sequence[Values], name: str) -> str:
    return " and ".join(f"{100.0 * v[name]:.1f}" for v in values) + " %"
