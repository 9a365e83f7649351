"""What contacts went through, in sentences."""

import math
from collections.abc import Iterator, Sequence

from models.contact.records import ATOM
from models.core.words import tally

from ...scenario.display import format_number
from ...scenario.units import format_time
from .contact_summary import RESOLVED, ContactSummaries, ContactSummary, Excursion

# Of each group of the film formula: what lies below, above, and on both sides of its range; its definition.
GROUPS = {
    "material": (
        "oil that thickens little",
        "oil that thickens much",
        "oil that thickens little or much",
        "pressure-viscosity x modulus",
    ),
    "squeeze": (
        "a film that shrinks fast",
        "a film that grows",
        "a film that shrinks fast or grows",
        "velocity of film / entraining velocity",
    ),
    "load": ("light load", "heavy load", "light or heavy load", "load / (modulus x radius x length)"),
    "speed": (
        "slow entrainment",
        "fast entrainment",
        "slow or fast entrainment",
        "viscosity x entraining velocity / (modulus x radius)",
    ),
}
# The films of docs/films.md through the cycle of `valve-train`, with squeeze, outside the ranges.
OFF = "0.6 to 3.2 times the solved one in valve-train"
# Of more contacts only those with the thinnest films have lines of their own.
SHOWN = 4
# A Hertz pressure (Pa) that dents bearing steel: ISO 76 has 4.0 GPa for rollers.
STEEL = 4e9
# A film feeds vibrations where the motion keeps this share of the power that goes to and fro through it, and
# this coefficient of rolling friction would be needed to take it. Trains that follow their cams stay below
# 0.13 and 2e-5; one that bounced by work of its film had 0.7 and 4e-4.
FED, ROLLING = 1.0 / 3.0, 1e-4


def lines(summaries: ContactSummaries, fixed_steps: bool) -> list[str]:
    """Contacts, of many those with the thinnest films, then warnings of all. With `fixed_steps` landings that
    macro steps do not resolve are warned of; step control resolves them."""
    lines = [f"{name}: {text}" for name, one in _list_shown(summaries) for text in _write_lines(one)]
    if len(summaries) > SHOWN:
        lines.append(f"{tally(len(summaries) - SHOWN, 'more contact')} with thicker films: see summary.json")
    for name, summary in summaries.items():
        lines += [f"{name}: {text}" for text in _warnings(name, summary, fixed_steps)]
    return lines


def _list_shown(summaries: ContactSummaries) -> list[tuple[str, ContactSummary]]:
    if len(summaries) <= SHOWN:
        return list(summaries.items())
    return sorted(summaries.items(), key=lambda item: item[1].film)[:SHOWN]


def name_estimates(summaries: ContactSummaries) -> list[str]:
    """Which films of the contacts that have lines are estimates, and why; `list_details` says it of all
    with the numbers."""
    return [
        f"{name}: its film is an estimate: "
        + ", ".join(f"{_name_causes(group, r)} in {_percent(r.share)} %" for group, r in one.ranges.items())
        + " of the time under load"
        + (", shares overlap" if len(one.ranges) > 1 else "")
        + "; ranges are in the report"
        for name, one in _list_shown(summaries)
        if one.ranges
    ]


def list_details(summaries: ContactSummaries, source: str) -> list[str]:
    """What few ask first: values and ranges of the groups of film formulas, and where extremes are from."""
    details = [
        f"{name}: outside the ranges of the film formula (Kushwaha 2000, Table 3) the film is an estimate, "
        f"{OFF}; film ratio and friction follow it, load and pressure hardly. Outside by "
        + "; ".join(_write_excursion(group, one) for group, one in summary.ranges.items())
        for name, summary in summaries.items()
        if summary.ranges
    ]
    if not summaries:
        return details
    longest = format_time(max(summary.longest_step for summary in summaries.values()))
    return [*details, f"extremes of contacts are those of {source}, {longest} apart at most"]


def name_turn(turns: Sequence[int]) -> str:
    """The first of these revolutions, behind an angle."""
    return f" of revolution {turns[0]}" if turns else ""


def _write_lines(summary: ContactSummary) -> Iterator[str]:
    def at(key: str) -> str:
        shaft = summary.angle_of.removesuffix("_angle")
        known = key in summary.angles
        if not known:
            return f"t = {summary.times()[key]:.6g} s"
        turn = name_turn([summary.turns[key]] if key in summary.turns else [])
        return f"{shaft} {summary.angles[key]:.1f} deg{turn}"

    when = " while the cam lifts" if summary.seated else ""
    whole = "" if summary.seated else " of the whole run"
    text = f"kept{when}, least load{whole} {summary.least_load:.4g} N at {at('least_load')}"
    if summary.least_load == math.inf:
        text = "the cam stays on its base circle and ramps, where no least load is judged"
    if summary.separation:
        text = f"lost{when}, in {100.0 * summary.lost:.3g} % of the whole run"
    text += f"; highest load {format_number(summary.largest_load)} N at {at('largest_load')}"
    text += f"; highest pressure {1e-6 * summary.pressure:.4g} MPa at {at('pressure')}"
    text += " (spikes at a reversal grow with the nodes)" if summary.solved else ""
    if summary.film > 0.0:
        least = f"least film {1e6 * summary.film:.3g} µm"
        text += f"; {least if summary.film >= ATOM else 'no film of smooth surfaces'} at {at('film')}, "
        which = "least ratio of the central film to roughness" if summary.solved else "least film ratio"
        borne = "" if summary.film >= ATOM else " under the fluid's share of the load"
        text += f"{which} {summary.film_ratio:.2g}{borne}" if summary.film_ratio > 0.0 else "smooth surfaces"
    yield text
    if s := summary.separation:
        longest = f"the longest {format_time(s.longest)} from {at('separation')}"
        text = f"{tally(s.count, 'separation')}, {longest}"
        gap = f"; largest gap {format_number(1e6 * s.gap, 3)} µm at {at('gap')}"
        yield text + (gap if s.gap > 0.0 else "")
    if summary.at_rest > 0.0:
        share = f"{100.0 * summary.at_rest:.3g} % of the whole run"
        yield f"open in {share}, on the base circle and its ramps"
    if summary.on_ramps > 0.0:
        share = f"{100.0 * summary.on_ramps:.3g} % of the whole run"
        lift = f"up to a lift of {1e3 * summary.ramp_lift:.3g} mm at {at('ramp')}"
        yield f"open in {share}, on the ramps above the lash, {lift}"
    if i := summary.impact:
        speed = f" with {i.speed:.3g} m/s" if i.speed > 0.0 else ""
        load = f"{format_number(i.load)} N, impulse {i.impulse:.3g} N s"
        yield f"hardest impact at {at('impact')}{speed}: {load}"


def _write_excursion(group: str, one: Excursion) -> str:
    extremes = f"{one.least:.2g} to {one.most:.2g}, range {one.low:g} to {one.high:g}"
    cause, words = _name_causes(group, one), GROUPS[group][-1]
    return f"{cause} in {_percent(one.share)} % of the time under load ({words}: {extremes})"


def _name_causes(group: str, one: Excursion) -> str:
    sides = (one.least < one.low) + 2 * (one.most > one.high)
    return ("no entrainment", *GROUPS[group])[sides]


def _warnings(name: str, summary: ContactSummary, fixed_steps: bool) -> Iterator[str]:
    if summary.pressure > summary.elastic_limit:
        pressure, limit = f"{1e-6 * summary.pressure:.4g} MPa", f"{1e-6 * summary.elastic_limit:.4g} MPa"
        cure = f"lower the load, or set components.{name}.parameters.elastic_limit to the material's"
        if summary.pressure > STEEL:
            cure = f"no steel bears more than {1e-6 * STEEL:g} MPa: look for a slip in speed, masses or radii"
        yield (
            f"the pressure reaches {pressure} at t = {summary.pressure_time:.6g} s, above the elastic limit "
            f"of {limit} ({_percent(summary.yielding)} % of the time): the bodies yield, which is not "
            f"computed; {cure}"
        )
    if summary.film_feed > FED and summary.film_friction > ROLLING:
        cure = f"compare with components.{name}.parameters.film_model = 'dowson_toyoda'"
        yield (
            f"the film gives {summary.film_power:.3g} W to the motion, which no shaft supplies: it feeds "
            "vibrations, so that loads, bounces and separations come out too large; "
            + (cure if summary.film_grows else "reduce macro_step or use step control")
        )
    impact = summary.impact
    if fixed_steps and impact and not impact.resolved and impact.load >= 0.5 * summary.largest_load:
        count = "one macro step" if impact.steps == 1 else f"{impact.steps} macro steps"
        yield (
            f"the hardest impact reaches its {impact.load:.4g} N within {count}, fewer than {RESOLVED}: "
            "this load, the rebound and what follows are not resolved; reduce macro_step or use step control"
        )


def _percent(share: float) -> str:
    return f"{100.0 * share:.1f}".removesuffix(".0")
