"""Two designs side by side, from their sweeps over speed."""

import csv
import json
import math
import re
import tomllib
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import xarray
from rich.table import Table

from models.core.system import System

from ...assessment.friction.losses import describe_content
from ...assessment.friction.shares import add_losses
from ...assessment.lost_contact import find_lost
from ...errors import Command, MistakeError, Option
from ...plots.speeds import draw_summary
from ...plots.style import save_figure
from ...reporter import Reporter
from ...scenario import build_scenario
from ...scenario.display import format_number, show_attributes
from ...scenario.system import build_system
from ...store.output_folder import STORE, SUMMARY, refuse_missing
from .subject import STEADY
from .sweep import parse_speed, read_table

RPM = 30.0 / math.pi
# Numbers of which the least is the worst; of the others it is the largest.
LEAST_IS_WORST = (
    "least_load", "least_film", "least_film_ratio", "nose_film", "nose_film_ratio", "spring_margin",
    "least_gap", "fatigue_safety", "largest_lift", "lift_area", "least_clearance", "least_radial_clearance",
    "seat_force_kept", "least_torque",
)  # fmt: skip
# The table of several designs. Of a name of a folder, all that is not one of these becomes an underscore.
VARIANTS = "variants.csv"
_UNSAFE = re.compile(r"[^\w.=+ -]")


@dataclass(frozen=True)
class Choice:
    """The speeds (rad/s) over which two sweeps are compared: a range, or the one nearest to `at`.

    Where a contact is lost in one of them both are left out, unless `lost` ones are wanted.
    """

    low: float = 0.0
    high: float = math.inf
    at: float | None = None
    lost: bool = False


def parse_choice(low: str | None, high: str | None, at: str | None, lost: bool) -> Choice:
    """The choice that options state as texts; MistakeError where they are no speeds, or contradict."""
    if at is not None and (low is not None or high is not None):
        raise MistakeError(
            (Option("at", at), ": is one speed; leave ", Option("from"), " and ", Option("to"), " out")
        )
    ends = {"from": low, "to": high, "at": at}
    values = {name: parse_speed(name, text) for name, text in ends.items() if text is not None}
    if values.get("from", 0.0) > values.get("to", math.inf):
        raise MistakeError((Option("from", low), ": must not be more than ", Option("to", high)))
    return Choice(values.get("from", 0.0), values.get("to", math.inf), values.get("at"), lost)


def compare(
    first: Path, second: Path, out: Path | None, reporter: Reporter, choice: Choice | None = None
) -> dict[str, Any]:
    """Print the worst of each number over the chosen speeds, and draw both sweeps in the file `out`.

    Returns what is printed: by number its unit and the worst of each design, None where it has none;
    by design its separation, and the one with a second film formula.
    """
    choice = choice or Choice()
    sweeps = dict(zip(label(first, second), map(read_sweep, (first, second)), strict=True))
    tables = [sweep.table for sweep in sweeps.values()]
    common = select_speeds(tables, choice)
    if not all(table.sizes["speed"] for table in common):
        with_lost = select_speeds(tables, replace(choice, lost=True))
        only_lost = all(table.sizes["speed"] for table in with_lost)
        kept = " at which both keep contact" if only_lost else " there"
        add = (("add ", Option("lost", True), " for the others"),) if only_lost else ()
        raise MistakeError(f"{first} and {second}: have no speeds in common{kept}", *add)
    ends = [f"{RPM * float(pick(table['speed'])):.0f}" for pick in (np.min, np.max) for table in common]
    title = f"{min(ends[:2], key=float)} to {max(ends[2:], key=float)} r/min"
    several = len(set(ends)) > 1
    title = title if several else f"{ends[0]} r/min"
    left_out = sum(table.sizes["speed"] for table in tables) - sum(t.sizes["speed"] for t in common)
    if left_out and not choice.lost and choice.at is None:
        title += ", where both keep contact"
    shown = Table("worst", "unit", *sweeps, title=title, title_justify="left")
    numbers: dict[str, Any] = {}
    every = dict.fromkeys(str(name) for table in common for name in table.data_vars)
    for name in every:
        values = next(table[name] for table in common if name in table)
        # Angles stand beside their numbers.
        if values.dtype.kind != "f" or name in STEADY or name.endswith("_angle"):
            continue
        display = show_attributes(values.attrs)
        unit, scale = display.text or "1", display.factor
        worst = [find_worst(table, name, scale) for table in common]
        if not any(worst):
            continue
        shown.add_row(name, unit, *(w.describe(several) if w else "–" for w in worst))
        plain = [w and asdict(w) for w in worst]
        numbers[name] = {"unit": unit, **dict(zip(sweeps, plain, strict=True))}
    reporter.console.print(shown)
    found: dict[str, Any] = {"worst": numbers}
    for kind in ("separation", "second_separation"):
        found[kind] = {name: sweep.summary.get(kind) for name, sweep in sweeps.items()}
        for name, separation in found[kind].items():
            if separation:
                reporter.line(f"{name}: {separation['text']}")
    whole = {name: add_losses(sweep.table, sweep.build_system()) for name, sweep in sweeps.items()}
    found["friction_outside"] = {name: table.attrs["outside"] for name, table in whole.items()}
    for name, outside in found["friction_outside"].items():
        reporter.line(f"{name}: the drive's torque is {describe_content(outside)}")
    if out is not None:
        separations = {name: one and one["speed"] for name, one in found["separation"].items()}
        reporter.line(f"figure: {save_figure(lambda: draw_summary(whole, separations), out)}")
    return found


@dataclass(frozen=True)
class Sweep:
    """A finished sweep: its cycles by speed, and its summary."""

    table: xarray.Dataset
    summary: dict[str, Any]

    def build_system(self) -> System:
        return build_system(build_scenario(tomllib.loads(self.summary["scenario_toml"])))


def read_sweep(folder: Path) -> Sweep:
    """MistakeError if there is none."""
    refuse_missing(folder)
    if not (folder / STORE).exists() or not (folder / SUMMARY).exists():
        remedy = Command("speeds", (...,), (Option("out", folder),))
        raise MistakeError(f"{folder}: holds no finished sweep", ("make one with ", remedy))
    return Sweep(read_table(folder), json.loads((folder / SUMMARY).read_text("utf-8")))


def label(first: Path, second: Path) -> tuple[str, str]:
    """The folders' names, or those of the designs in them; where both have the same, numbered."""
    names = tuple(map(_name_design, (first, second)))
    return (names[0], names[1]) if names[0] != names[1] else (f"{names[0]} (1)", f"{names[1]} (2)")


def name_folder(design: str) -> str:
    """Of the sweep of one of several designs."""
    return _UNSAFE.sub("_", design) or "scenario"


def _name_design(folder: Path) -> str:
    """As the table of several designs beside the folder has it, else the folder's name."""
    table = folder.parent / VARIANTS
    rows = csv.DictReader(table.read_text("utf-8-sig").splitlines()) if table.is_file() else ()
    return next((row["design"] for row in rows if name_folder(row["design"]) == folder.name), folder.name)


@dataclass(frozen=True)
class Worst:
    """The worst value over speed, in the unit that is shown; its speed (r/min) and, where the cycle has one
    place, its cam angle (degrees)."""

    value: float
    speed_rpm: float
    angle_deg: float | None = None

    def describe(self, with_speed: bool) -> str:
        """The value and its place."""
        speed = [f"{self.speed_rpm:.0f}"] * with_speed
        place = [*speed, *([] if self.angle_deg is None else [f"{self.angle_deg:.0f}°"])]
        return format_number(self.value, 5) + (f" at {', '.join(place)}" if place else "")


def is_least_worst(name: str) -> bool:
    """Of a number "part.figure"; of others the largest is the worst."""
    return name.rpartition(".")[2] in LEAST_IS_WORST


def find_worst(table: xarray.Dataset, name: str, scale: float) -> Worst | None:
    """The worst value of a number; None where it has none."""
    if name not in table or not np.any(np.isfinite(values := table[name].values)):
        return None
    worst = int(np.nanargmin(values) if is_least_worst(name) else np.nanargmax(values))
    angles = table.get(f"{name}_angle")
    angle = None if angles is None else math.degrees(float(angles.values[worst]))
    return Worst(scale * float(values[worst]), RPM * float(table["speed"].values[worst]), angle)


def _check_inside(at: float, speeds: Any) -> None:
    """MistakeError for a speed that is not between the computed ones."""
    low, high = speeds.min(), speeds.max()
    if not low * (1 - 1e-9) <= at <= high * (1 + 1e-9):
        between = f"must be from {RPM * low:.0f} to {RPM * high:.0f} r/min, which were computed"
        raise MistakeError((Option("at", f"{RPM * at:.0f} rpm"), f": {between}"))


def select_speeds(tables: list[xarray.Dataset], choice: Choice) -> list[xarray.Dataset]:
    """The chosen speeds of both tables, which may have different ones."""
    found = []
    for table, other in zip(tables, tables[::-1], strict=True):
        speeds, lost = table["speed"].values, find_lost(table)
        nearest = np.abs(other["speed"].values - speeds[:, None]).argmin(axis=1)
        inside = [other["speed"].values.min(), other["speed"].values.max()]
        low, high = max(choice.low, inside[0]), min(choice.high, inside[1])
        chosen = (speeds >= low * (1 - 1e-9)) & (speeds <= high * (1 + 1e-9))
        if choice.at is not None:
            chosen = np.arange(speeds.size) == np.abs(speeds - choice.at).argmin()
            _check_inside(choice.at, speeds)
        elif not choice.lost:
            chosen &= ~lost & ~find_lost(other)[nearest]
        found.append(table.isel(speed=np.flatnonzero(chosen)))
    return found
