"""Sweeps over speed of several designs: a scenario with each of several values, in one table and figure."""

import itertools
import math
import re
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import xarray
from numpy.typing import NDArray
from rich.table import Column as Head
from rich.table import Table

from models.core.interruption import deferred, look

from ...assessment.friction.losses import describe_content
from ...assessment.friction.shares import WHOLE
from ...assessment.lost_contact import find_lost, find_rippled, find_unsteady
from ...assessment.springs import remark_masses
from ...errors import MistakeError, Option
from ...plots.speeds import draw_variants
from ...plots.style import save_figure
from ...reporter import Reporter
from ...scenario import build_scenario
from ...scenario.display import Shown, add_unit, format_number, show_attributes
from ...scenario.system import build_system
from ...store.csv_file import write_rows
from ...texts import is_toml, parse_toml
from .compare import VARIANTS, Worst, find_worst, is_least_worst, name_folder
from .sweep import Swept

FIGURE = "variants.png"
RPM = 30.0 / math.pi
# What a design is chosen by: figures of contacts, valves, springs, pistons, adjusters and drives.
CHOSEN_BY = (
    "least_load", "largest_load", "peak_pressure", "nose_pressure", "least_film", "least_film_ratio",
    "nose_film_ratio", "largest_lift", "lift_area", "spring_margin", "seating_velocity", "bounce",
    "landing_lift", "ramp_left", "least_lift", "least_gap", "least_clearance", "chamber_pressure",
    "lift_loss", "held_open", "largest_torque", "mean_torque", "friction_power",
)  # fmt: skip
# Of more parts with a figure the printed table has the one where it is worst.
FEW = 2
# Designs in a printed table, and the width of a column that holds their names.
BESIDE, NARROW = 4, 13
# From here on a description explains itself.
EXPLAINED = re.compile("[,;:]| in radians")
# A number with its unit.
_NUMBER = re.compile(r"([-+]?[\d.]+(?:[eE][-+]?\d+)?) *(.*)")
# A number without its unit before digits with one: 0,2 mm.
_DECIMAL_COMMA = re.compile(r"(?:^|,) *([+-]?\d+),(\d+ *[^\W\d][^,]*)")
# A value of several: commas in brackets and quotes are its own.
_VALUE = re.compile(r"""(?:\[[^]]*\]|\{[^}]*\}|"[^"]*"|'[^']*'|[^,])+""")


@dataclass(frozen=True)
class Variant:
    """A design: what distinguishes it, and the settings "path=value" that make it."""

    label: str
    settings: tuple[str, ...]
    # Name and value of each setting that has several.
    varied: tuple[tuple[str, str], ...] = field(default=(), compare=False)

    @property
    def folder(self) -> str:
        return name_folder(self.label)


def list_variants(settings: Sequence[str]) -> list[Variant]:
    """Every combination of the values of settings such as "path=A,B,C"; those with one value are in all."""
    choices = []
    several = [text.partition("=") for text in settings]
    ends = [path.strip().rpartition(".")[2] for path, _, written in several if len(_split(written)) > 1]
    for text in settings:
        path, equals, written = text.partition("=")
        values = _split(written) if equals else [written]
        short = path.strip().rpartition(".")[2]
        short = path.strip() if ends.count(short) > 1 else short
        varied = [((short, value),) if len(values) > 1 else () for value in values]
        choices.append([(pair, f"{path}{equals}{value}") for pair, value in zip(varied, values, strict=True)])
    found = []
    for combined in itertools.product(*choices):
        pairs = tuple(pair for varied, _ in combined for pair in varied)
        label = ", ".join(f"{short}={value}" for short, value in pairs)
        found.append(Variant(label, tuple(text for _, text in combined), pairs))
    folders = [variant.folder for variant in found]
    if len(set(folders)) < len(folders):
        raise MistakeError((Option("set"), ": the same value twice"))
    return found


def _split(written: str) -> list[str]:
    """The values between commas; one where the whole is a value, such as a list or a quoted text.

    MistakeError for a decimal comma.
    """
    if is_toml(written.strip()):
        return [written]
    if comma := _DECIMAL_COMMA.search(written):
        said = f": '{comma[1]},{comma[2]}': a comma stands between values"
        remedy = f"write {comma[1]}.{comma[2]}, with a point, or the unit of each value"
        raise MistakeError((Option("set"), said), remedy)
    return [value.strip() for value in _VALUE.findall(written) if value.strip()] or [written]


def sweep_variants(
    designs: Mapping[Variant, Mapping[str, Any]],
    out: Path,
    reporter: Reporter,
    sweep: Callable[[Mapping[str, Any], Path], Swept],
) -> dict[str, Swept]:
    """Sweep each design by `sweep(tables, folder)` in a folder of `out`, then put all side by side; by the
    variants' labels. If Ctrl-C ends it, those that are there are put side by side."""
    found: dict[str, Swept] = {}
    try:
        with deferred():
            for number, (variant, tables) in enumerate(designs.items(), 1):
                reporter.line(f"{variant.label} ({number} of {len(designs)})")
                found[variant.label] = sweep(tables, out / variant.folder)
                look()
    finally:
        if swept := {label: one for label, one in found.items() if one.table.sizes["speed"]}:
            _report(swept, [one for one in designs if one.label in swept], out, reporter)
    return found


@dataclass(frozen=True)
class Column:
    """A figure "part.name" of all designs and their worst values; how it is headed and shown. `partial`: a
    torque of the drive that does not contain all friction."""

    name: str
    head: str
    shown: Shown
    worst: Sequence[Worst | None]
    angle: str
    partial: bool = False

    def list_cells(self) -> list[str]:
        """Title and values, with the speed: in the title where it is that of all designs."""
        speeds = {f"{worst.speed_rpm:.0f}" for worst in self.worst if worst}
        head = f"{self.head}, {self.shown.text}".removesuffix(", ") + " *" * self.partial
        head += " (° of the crank)" * self.angle.startswith("crank")
        head += f", at {speeds.pop()} r/min" if len(speeds) == 1 else ""
        return [head, *(worst.describe(bool(speeds)) if worst else "–" for worst in self.worst)]

    @property
    def badness(self) -> float:
        """The worst of all designs, larger where worse."""
        values = [worst.value for worst in self.worst if worst]
        return -min(values) if is_least_worst(self.name) else max(values)

    def write(self) -> Iterator[list[str]]:
        """Head and values of its columns: the number, its speed and its angle."""
        yield [add_unit(self.head, self.shown), *(format_number(w.value) if w else "" for w in self.worst)]
        yield [f"{self.head}, at [r/min]", *(f"{w.speed_rpm:.0f}" if w else "" for w in self.worst)]
        if self.angle:
            angles = (w.angle_deg if w else None for w in self.worst)
            yield [f"{self.angle} [deg]", *("" if a is None else format_number(a) for a in angles)]


class Judged(NamedTuple):
    """Designs at the speeds over which all are judged, without any speed of one that is not; at all speeds
    where each is `good`; the ends (r/min) of the speeds, "" where no design is good at any."""

    tables: Sequence[xarray.Dataset]
    good: Sequence[xarray.Dataset]
    low: str = ""
    high: str = ""


def choose_speeds(swept: Mapping[str, Swept]) -> Judged:
    """Designs are judged where all of them are good: where contact is kept and the cycle steady. One that is
    good at no speed of those that are good at more is left out. Where none is good, each has all its own."""
    every = [one.table for one in swept.values()]
    good = [table.isel(speed=np.flatnonzero(_find_good(table))) for table in every]
    common = np.array([])
    for table in sorted(good, key=lambda table: -table.sizes["speed"]):
        shared = np.intersect1d(table["speed"].values, common) if common.size else table["speed"].values
        common = shared if shared.size else common
    if not common.size:
        return Judged(every, every)
    judged = [one.sel(speed=common if np.isin(common, one["speed"]).all() else []) for one in good]
    return Judged(judged, good, *(f"{RPM * speed:.0f}" for speed in (common.min(), common.max())))


def tabulate(judged: Judged) -> list[Column]:
    """The figures by which a design is chosen, of all parts that have them."""
    every = dict.fromkeys(str(name) for table in judged.tables for name in table.data_vars)
    columns = []
    for figure in CHOSEN_BY:
        names = list_parts_with(figure, every)
        for name in names:
            attributes = next(table[name].attrs for table in judged.tables if name in table)
            shown = show_attributes(attributes)
            worst = [find_worst(table, name, shown.factor) for table in judged.tables]
            partial = name.endswith("_torque") and any(table.attrs.get("outside") for table in judged.tables)
            of = f" of {name.rpartition('.')[0]}" * (len(names) > 1)
            angles = (_name(t[a].attrs, a) + of for t in judged.tables if (a := f"{name}_angle") in t)
            if any(worst):
                head = _name(attributes, figure) + of
                columns.append(Column(name, head, shown, worst, next(angles, ""), partial))
    return columns


def list_parts_with(figure: str, every: Collection[str]) -> list[str]:
    """The names "part.figure" among `every` name: of the whole train, else of contacts, else of others."""
    names = [name for name in every if name.endswith(f".{figure}")]
    contacts = [name for name in names if f"{name.rpartition('.')[0]}.lost" in every]
    return [name for name in names if name.startswith(WHOLE)] or contacts or names


def _name(attributes: Mapping[Any, Any], figure: str) -> str:
    return EXPLAINED.split(str(attributes.get("long_name", figure.replace("_", " "))))[0]


def _find_lost_from(one: Swept) -> str:
    """The speed (r/min) of separation; where it was not looked for, the computed speeds on both sides of it;
    empty where contact is kept."""
    if speed := (one.summary.get("separation") or {}).get("speed"):
        return f"{speed:.0f}"
    lost = find_lost(one.table)
    if not lost.any():
        return ""
    first, speeds = int(np.argmax(lost)), [f"{RPM * speed:.0f}" for speed in one.table["speed"].values]
    return f"{speeds[first - 1]} to {speeds[first]}" if first else f"≤ {speeds[0]}"


def describe_landing(judged: Judged, labels: Sequence[str]) -> Iterator[str]:
    """Which designs close their valves and land on the closing ramps at all their good speeds, and why the
    others do not; nothing of cams without ramps."""
    every = dict.fromkeys(str(name) for table in judged.good for name in table.data_vars)
    ramps = list_parts_with("ramp_left", every)
    if not any(find_worst(table, name, 1.0) for table in judged.good for name in ramps):
        return
    names = [*ramps, *list_parts_with("least_lift", every)]
    faults = {
        label: [said for name in names if (said := _find_fault(table, name))]
        for label, table in zip(labels, judged.good, strict=True)
        if table.sizes["speed"]
    }
    kept = [label for label, found in faults.items() if not found] or ["none of these"]
    others = [f"{label} ({', '.join(found)})" for label, found in faults.items() if found]
    rest = f"; not with {'; '.join(others)}" if others else ""
    yield f"valves close, and land on the ramps, with {'; '.join(kept)}{rest}"


def describe_frugal(swept: Mapping[str, Swept]) -> Iterator[str]:
    """The design of least friction among those that keep contact up to the highest speed at which any does,
    and why the others drop out; nothing of trains without contacts, friction or a design that keeps it."""
    every = dict.fromkeys(str(name) for one in swept.values() for name in one.table.data_vars)
    names = list_parts_with("friction_power", every)
    if len(names) != 1 or not any(name.endswith(".lost") for name in every):
        return
    kept, ends = dict[str, xarray.Dataset](), dict[str, float]()
    for label, one in swept.items():
        good = _find_good(one.table)
        kept[label] = one.table.isel(speed=slice(None if good.all() else int(np.argmin(good))))
        ends[label] = RPM * float(kept[label]["speed"].values.max(initial=0.0))
    highest = max(ends.values())
    powers = {
        label: worst
        for label, table in kept.items()
        if ends[label] == highest and (worst := find_worst(table, names[0], 1.0))
    }
    if not powers:
        return
    least = min(powers, key=lambda label: powers[label].value)
    said = (
        f"least friction with contact up to {highest:.0f} r/min: {least}, at most "
        f"{powers[least].value:.4g} W, at {powers[least].speed_rpm:.0f} r/min"
    )
    others = [f"{label} ({_explain_end(one)})" for label, one in swept.items() if label not in powers]
    yield f"{said}; not up to there: {'; '.join(others)}" if others else said


def _find_good(table: xarray.Dataset) -> NDArray[np.bool_]:
    """At which speeds contact is kept and the cycle is steady."""
    return ~(find_lost(table) | find_rippled(table))


def _explain_end(one: Swept) -> str:
    """What ends the speeds up to which a design is good."""
    separation = (one.summary.get("separation") or {}).get("speed")
    if lost := f"{separation:.5g}" if separation else _find_lost_from(one):
        return f"contact lost from {lost} r/min"
    rippled = RPM * one.table["speed"].values[find_rippled(one.table)]
    return f"not steady at {rippled[0]:.0f} r/min" if rippled.size else "no cycle at higher speeds"


def join_remarks(swept: Mapping[str, Swept]) -> Iterator[str]:
    """What the sweeps say of friction, each once: after the designs of which it holds, if not all."""
    holds: dict[str, list[str]] = {}
    for label, one in swept.items():
        for text in one.summary.get("friction", ()):
            holds.setdefault(text, []).append(label)
    for text, labels in holds.items():
        yield text if len(labels) == len(swept) else f"with {'; '.join(labels)}: {text}"


def _find_fault(table: xarray.Dataset, name: str) -> str:
    """What the worst `ramp_left` or `least_lift` of a valve says against a design."""
    (valve, _, figure), worst = name.rpartition("."), find_worst(table, name, 1.0)
    if worst and figure == "ramp_left" and worst.value > 1.0:
        return f"{valve} lands at {worst.value:.3g} of its ramp, at {worst.speed_rpm:.0f} r/min"
    if worst and figure == "least_lift" and worst.value > 0.0:
        return f"{valve} stays open by {1e6 * worst.value:.3g} µm, at {worst.speed_rpm:.0f} r/min"
    return ""


def _list_varied(variants: Sequence[Variant]) -> Iterator[list[str]]:
    """Head and values of each setting that has several; numbers of one unit have it in the head."""
    for pairs in zip(*(variant.varied for variant in variants), strict=True):
        name, values = pairs[0][0], [value for _, value in pairs]
        numbers = [_NUMBER.fullmatch(value) for value in values]
        units = {number[2] if number else None for number in numbers}
        if units <= {""} or None in units or len(units) > 1:
            yield [name, *values]
        else:
            yield [f"{name} [{units.pop()}]", *(number[1] for number in numbers if number)]


def _report(swept: Mapping[str, Swept], variants: Sequence[Variant], out: Path, reporter: Reporter) -> None:
    judged = choose_speeds(swept)
    columns, left_out = tabulate(judged), " but those marked –" * any(not t.speed.size for t in judged.tables)
    where = f"from {judged.low} to {judged.high} r/min, where all{left_out} keep contact and are steady"
    where = where if judged.low else "at all speeds: no design keeps contact and is steady at any"
    lost = [_find_lost_from(one) for one in swept.values()]
    unsteady = [list(find_unsteady(one.table)) for one in swept.values()]
    for first in range(0, len(swept), BESIDE):
        several = slice(first, first + BESIDE)
        heads = (
            Head(label, overflow="fold", min_width=min(len(label), NARROW)) for label in [*swept][several]
        )
        shown = Table("worst", *heads, title=f"Worst {where}; at r/min, ° of the cam", title_justify="left")
        shown.add_row("contact lost from, r/min", *(text or "–" for text in lost[several]))
        if any(unsteady):
            shown.add_row("speeds without a steady cycle", *(str(len(one)) for one in unsteady[several]))
        for column in choose_shown(columns):
            head, *cells = column.list_cells()
            shown.add_row(head, *cells[several])
        reporter.console.print(shown)
    for outside in {table.attrs["outside"]: 0 for table in judged.tables if table.attrs.get("outside")}:
        reporter.line(f"* {describe_content(outside)}")
    tomls = [text for one in swept.values() if (text := one.summary.get("scenario_toml"))]
    systems = [build_system(build_scenario(parse_toml(text))) for text in tomls]
    for line in (
        *describe_landing(judged, list(swept)), *describe_frugal(swept), *join_remarks(swept),
        *(remark_masses(systems) if systems else ()),
    ):  # fmt: skip
        reporter.line(line)
    rows = [
        ["design", *swept],
        *_list_varied(variants),
        *(
            [f"judged {name} [r/min]", *(end * bool(table.sizes["speed"]) for table in judged.tables)]
            for name, end in (("from", judged.low), ("to", judged.high))
        ),
        ["contact lost from [r/min]", *lost],
        ["no steady cycle at [r/min]", *(" ".join(f"{RPM * v:.0f}" for v in one) for one in unsteady)],
        *(row for column in columns for row in column.write()),
    ]
    write_rows(out / VARIANTS, zip(*rows, strict=True))
    tables = {label: one.table for label, one in swept.items()}
    save_figure(lambda: draw_variants(tables), out / FIGURE)
    reporter.line(f"designs in {out}: {VARIANTS}, {FIGURE}")


def choose_shown(columns: Sequence[Column]) -> list[Column]:
    """All of few parts with a figure; of many the one where it is worst."""
    chosen = []
    for _, same in itertools.groupby(columns, lambda column: column.name.rpartition(".")[2]):
        every = list(same)
        chosen += every if len(every) <= FEW else [max(every, key=lambda column: column.badness)]
    return chosen
