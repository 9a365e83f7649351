"""Two runs side by side: their figures of merit, and their valve trains in one figure."""

import csv
from dataclasses import replace
from pathlib import Path
from typing import Any

from rich.table import Table

from ..errors import Command, MistakeError, Option
from ..plots import valve_train
from ..plots.data import FigureData
from ..plots.style import save_figure
from ..reporter import Reporter
from ..store.output_folder import MERITS, STORE, is_run, refuse_missing
from .speeds.compare import label


def compare_runs(first: Path, second: Path, out: Path | None, reporter: Reporter) -> dict[str, Any]:
    """Print the figures of merit that both runs have and unless zero in both; draw both in `out`.

    Returns all that both have, by "part: figure", and the figure. MistakeError where one is no run.
    """
    for folder, other in ((first, second), (second, first)):
        if (folder / STORE).exists():
            raise MistakeError(
                f"{folder}: is a sweep over speed, and {other} a run; compare two sweeps, or two runs"
            )
    names = label(first, second)
    drawn = overlay(first, second, out, names) if out else None
    tables = {name: read_merits(folder) for name, folder in zip(names, (first, second), strict=True)}
    one, other_one = tables.values()
    shown = Table("figure of merit", "unit", *names)
    merits: dict[str, Any] = {}
    for figure in (figure for figure in one if figure in other_one):
        rows = {name: table[figure] for name, table in tables.items()}
        # That of each where an older version wrote the one table in another unit.
        unit = " / ".join(dict.fromkeys(row["unit"] or "1" for row in rows.values()))
        if any(float(row["value"]) for row in rows.values()):
            shown.add_row(figure, unit, *map(_describe_merit, rows.values()))
        merits[figure] = {"unit": unit, **{name: _to_numbers(row) for name, row in rows.items()}}
    reporter.console.print(shown)
    for name, table in tables.items():
        notes = {
            figure: note
            for figure, row in table.items()
            if (note := row.get("friction")) and "torque" in figure
        }
        for note in dict.fromkeys(note for note in notes.values() if note.startswith("with")):
            reporter.line(f"{name}: the drive's torque is {note}")
    if drawn:
        reporter.line(f"figure: {drawn}")
    return {"merits": merits, "figure": drawn}


def read_merits(folder: Path) -> dict[str, dict[str, str]]:
    """The rows of a run's table by "part: figure"; none where it has no table."""
    path = folder / MERITS
    if not path.is_file():
        return {}
    with path.open(encoding="utf-8-sig", newline="") as file:
        rows = [row for row in csv.DictReader(file) if row["value"]]  # others are what is doubted
    return {f"{row['part']}: {row['figure of merit']}": row for row in rows}


def _describe_merit(row: dict[str, str]) -> str:
    """Its value, and the angle at which it stands, or the time."""
    if row["angle [deg]"]:
        return f"{row['value']} at {float(row['angle [deg]']):.1f}°"
    time = row["time [ms]"]
    return f"{row['value']} at t = {1e-3 * float(time):.6g} s" if time else row["value"]


def _to_numbers(row: dict[str, str]) -> dict[str, float | None]:
    heads = {"value": "value", "angle_deg": "angle [deg]", "time_ms": "time [ms]"}
    return {name: float(row[head]) if row[head] else None for name, head in heads.items()}


def overlay(first: Path, second: Path, out: Path, names: tuple[str, str]) -> Path:
    """Draw the design-review figure of the first run with the second one beneath it; MistakeError where the
    second has no such train."""
    one, other = map(read_run, (first, second))
    if not valve_train.applies(one):
        raise MistakeError(f"{first}: has no valve train with all its outputs recorded")
    parts = {part for train in one.trains for part in train.parts}
    wanted = [name for name in one.coupled if name.split(".")[0] in parts]
    if missing := [name for name in wanted if name not in other.coupled]:
        raise MistakeError(
            f"{second}: is a run of another train than {first}, without its {missing[0]}",
            "compare runs of one train",
        )
    both = replace(
        one, title=" and ".join(names), names=names, reference=other.coupled, reference_time=other.time
    )
    return save_figure(lambda: valve_train.draw(both), out)


def read_run(folder: Path) -> FigureData:
    """The run in the folder; MistakeError if it has none."""
    refuse_missing(folder)
    if not is_run(folder):
        remedy = Command("run", (...,), (Option("out", folder),))
        raise MistakeError(f"{folder}: holds no finished run", ("make one with ", remedy))
    return FigureData.read(folder)
