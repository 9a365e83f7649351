"""Two designs side by side, from their sweeps over speed."""

import json
import math
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np
import xarray
from rich.table import Table

from ...errors import Command, MistakeError, Option
from ...plots.speeds import draw_summary
from ...plots.style import save_figure
from ...reporter import Reporter
from ...store.output_folder import STORE, SUMMARY
from .sweep import read_table

RPM = 30.0 / math.pi
# Numbers of which the least is the worst; of the others it is the largest.
LEAST_IS_WORST = (
    "least_load",
    "least_film",
    "least_film_ratio",
    "spring_margin",
    "least_gap",
    "largest_lift",
    "lift_area",
    "least_torque",
)
# Numbers that are neither good nor bad.
LEFT_OUT = ("change", "periods", "least_load_angle")
# Units as people read them, with their factors.
SHOWN = {"m": ("mm", 1e3), "Pa": ("MPa", 1e-6), "rad": ("deg", math.degrees(1.0))}


def compare(first: Path, second: Path, out: Path | None, reporter: Reporter) -> dict[str, Any]:
    """Print the worst of each number over the speeds that both sweeps span, and draw both in the file `out`.

    Returns what is printed: by number its unit and the worst of each design; by design its separation, and
    the one with a second film formula.
    """
    tables = dict(zip(label(first, second), map(read_sweep, (first, second)), strict=True))
    low = max(float(table["speed"].min()) for table in tables.values())
    high = min(float(table["speed"].max()) for table in tables.values())
    if not low < high:
        raise MistakeError(f"{first} and {second}: have no range of speed in common")
    common = [table.sel(speed=slice(low * (1 - 1e-12), high * (1 + 1e-12))) for table in tables.values()]
    title = f"{low * RPM:.0f} to {high * RPM:.0f} r/min"
    shown = Table("worst", "unit", *tables, title=title, title_justify="left")
    numbers: dict[str, Any] = {}
    for name in map(str, common[0].data_vars):
        values = common[0][name]
        if name not in common[1] or values.dtype.kind != "f" or name.rpartition(".")[2] in LEFT_OUT:
            continue
        unit, scale = choose_unit(name, values.attrs.get("units", ""))
        worst = [find_worst(table, name, scale) for table in common]
        shown.add_row(name, unit, *(f"{w.value:.5g} at {w.speed_rpm:.0f}" if w else "–" for w in worst))
        plain = [w and asdict(w) for w in worst]
        numbers[name] = {"unit": unit, **dict(zip(tables, plain, strict=True))}
    reporter.console.print(shown)
    summaries = {
        name: json.loads((folder / SUMMARY).read_text("utf-8"))
        for name, folder in zip(tables, (first, second), strict=True)
    }
    found: dict[str, Any] = {"worst": numbers}
    for kind in ("separation", "second_separation"):
        found[kind] = {name: summary.get(kind) for name, summary in summaries.items()}
        for name, separation in found[kind].items():
            if separation:
                reporter.line(f"{name}: {separation['text']}")
    if out is not None:
        reporter.line(f"figure: {save_figure(lambda: draw_summary(tables), out)}")
    return found


def read_sweep(folder: Path) -> xarray.Dataset:
    """The table of a sweep; MistakeError if there is none."""
    if not (folder / STORE).exists() or not (folder / SUMMARY).exists():
        remedy = Command("speeds", (...,), (Option("out", folder),))
        raise MistakeError(f"{folder}: holds no finished sweep", ("make one with ", remedy))
    return read_table(folder)


def choose_unit(name: str, unit: str) -> tuple[str, float]:
    """The unit in which the number is shown, and its factor."""
    return ("um", 1e6) if name.endswith(("_film", ".bounce")) else SHOWN.get(unit, (unit, 1.0))


def label(first: Path, second: Path) -> tuple[str, str]:
    """The folders' names; where both have the same, numbered."""
    if first.name != second.name:
        return first.name, second.name
    return f"{first.name} (1)", f"{second.name} (2)"


@dataclass(frozen=True)
class Worst:
    """The worst value over speed, in the unit that is shown, and the speed (r/min) at which it is."""

    value: float
    speed_rpm: float


def find_worst(table: xarray.Dataset, name: str, scale: float) -> Worst | None:
    """The worst value of a number; None where it has none."""
    values = table[name].values
    if not np.any(np.isfinite(values)):
        return None
    least = name.rpartition(".")[2] in LEAST_IS_WORST
    worst = int(np.nanargmin(values) if least else np.nanargmax(values))
    return Worst(scale * float(values[worst]), RPM * float(table["speed"].values[worst]))
