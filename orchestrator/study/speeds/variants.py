"""Sweeps over speed of several designs: a scenario with each of several values, in one table and figure."""

import itertools
import math
import re
import tomllib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import xarray
from rich.table import Table

from models.core.interruption import deferred, look

from ...assessment.lost_contact import find_lost
from ...errors import MistakeError, Option
from ...plots.speeds import draw_variants
from ...plots.style import save_figure
from ...reporter import Reporter
from ...scenario.display import format_number
from ...store.csv_file import write_rows
from .compare import VARIANTS, find_worst, name_folder
from .sweep import Swept, select_columns

FIGURE = "variants.png"
RPM = 30.0 / math.pi
# A value of several: commas in brackets and quotes are its own.
_VALUE = re.compile(r"""(?:\[[^]]*\]|\{[^}]*\}|"[^"]*"|'[^']*'|[^,])+""")


@dataclass(frozen=True)
class Variant:
    """A design: what distinguishes it, and the settings "path=value" that make it."""

    label: str
    settings: tuple[str, ...]

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
        shown = [f"{short}={value}" if len(values) > 1 else "" for value in values]
        choices.append(
            [(label, f"{path}{equals}{value}") for label, value in zip(shown, values, strict=True)]
        )
    found = []
    for combined in itertools.product(*choices):
        label = ", ".join(short for short, _ in combined if short)
        found.append(Variant(label, tuple(text for _, text in combined)))
    folders = [variant.folder for variant in found]
    if len(set(folders)) < len(folders):
        raise MistakeError((Option("set"), ": the same value twice"))
    return found


def _split(written: str) -> list[str]:
    """The values between commas; one where the whole is a value, such as a list or a quoted text."""
    try:
        tomllib.loads(f"value = {written.strip()}")
    except tomllib.TOMLDecodeError:
        return [value.strip() for value in _VALUE.findall(written) if value.strip()] or [written]
    return [written]


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
            _report(swept, out, reporter)
    return found


def tabulate(swept: Mapping[str, Swept]) -> tuple[str, list[dict[str, str]]]:
    """The speeds that are judged, in words, and a row for each design: its speed of separation, and the worst
    of each number. These are the speeds at which all designs keep contact, if there are any."""
    kept = keep_contact([one.table for one in swept.values()])
    columns: dict[str, dict[str, float]] = {}  # by head: results and their factors
    for table in kept:
        for head, name, scale in select_columns(table):
            if not name.endswith(("_angle", ".lost")):
                columns.setdefault(head, {})[name] = scale
    rows = []
    for (label, one), table in zip(swept.items(), kept, strict=True):
        separation = (one.summary.get("separation") or {}).get("speed")
        row = {"design": label, "contact lost from r/min": "–" if separation is None else f"{separation:.0f}"}
        for head, names in columns.items():
            every = (find_worst(table, name, scale) for name, scale in names.items() if name in table)
            worst = next(filter(None, every), None)
            row[head] = format_number(worst.value) if worst else "–"
        rows.append(row)
    speeds = RPM * kept[0]["speed"].values
    lost = any(find_lost(table).any() for table in kept)
    where = "at each of which one loses contact" if lost else "where all keep contact"
    return f"{speeds.min():.0f} to {speeds.max():.0f} r/min, {where}", rows


def keep_contact(tables: Sequence[xarray.Dataset]) -> list[xarray.Dataset]:
    """The tables at the speeds that all have and at which none loses contact; at all that they have in
    common, where there is none."""
    speeds = [set(table["speed"].values) for table in tables]
    common = sorted(set.intersection(*speeds))
    same = [table.sel(speed=common) for table in tables]
    lost = np.any([find_lost(table) for table in same], axis=0)
    return same if lost.all() else [table.isel(speed=np.flatnonzero(~lost)) for table in same]


def _report(swept: Mapping[str, Swept], out: Path, reporter: Reporter) -> None:
    if not set.intersection(*(set(one.table["speed"].values) for one in swept.values())):
        reporter.line("the designs have no speed in common at which a cycle was found: no table of all")
        return
    speeds, rows = tabulate(swept)
    shown = Table("worst", title=f"Worst from {speeds}", title_justify="left")
    for row in rows:
        shown.add_column(row["design"], overflow="fold")
    for head in list(rows[0])[1:]:
        shown.add_row(head, *(row[head] for row in rows))
    reporter.console.print(shown)
    write_rows(out / VARIANTS, [list(rows[0]), *(row.values() for row in rows)])
    tables = {label: one.table for label, one in swept.items()}
    save_figure(lambda: draw_variants(tables), out / FIGURE)
    reporter.line(f"designs in {out}: {VARIANTS}, {FIGURE}")
