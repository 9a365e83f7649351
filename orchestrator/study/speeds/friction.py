"""Friction of whole trains over speed by shares, of a sweep or of several designs such as temperatures."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import matplotlib
import numpy as np
from matplotlib.figure import Figure
from rich.table import Table

from models.core.quantities import Vector
from models.core.roles import Drive
from models.monolithic.cycle import STEADY

from ...assessment.friction.losses import SHARES, list_losses, name_outside
from ...assessment.friction.remarks import find_film_ratios, list_soft
from ...assessment.trains import list_parts
from ...errors import MistakeError
from ...plots.style import create_grid
from ...reporter import make_table
from ...scenario.display import format_number
from ...store.csv_file import write_rows
from ...store.output_folder import STORE, SUMMARY
from .compare import read_sweep

RPM = 30.0 / math.pi
DRIVE, WHOLE = "drive", "drive with all friction"
# Panels side by side.
COLUMNS = 3


@dataclass(frozen=True)
class Sheet:
    """A design's speeds (r/min) of the drive, and mean torques (N m) on it by share; what the drive gives;
    `whole` has the friction outside the motion too.

    `unsteady` are speeds at which no steady cycle was found: they have no means and are left out. `outside`
    names the friction that what the drive gives does not contain, `soft` are the contacts of `list_soft`.
    """

    design: str
    speeds: Vector
    torques: dict[str, Vector]
    drive: Vector
    whole: Vector
    unsteady: Vector
    outside: str
    soft: Sequence[str] = ()

    @property
    def total(self) -> Vector:
        return np.sum(list(self.torques.values()), axis=0)


def list_sweeps(folder: Path) -> list[Path]:
    """The sweeps in a folder: itself, or its designs in the order in which they were swept."""
    if (folder / STORE).exists():
        return [folder]
    found = [path.parent for path in folder.glob(f"*/{SUMMARY}") if (path.parent / STORE).exists()]
    return sorted(found, key=lambda path: (path / SUMMARY).stat().st_mtime)


def read_sheet(folder: Path) -> Sheet:
    """MistakeError if the folder holds no finished sweep, or none with a steady cycle."""
    sweep = read_sweep(folder)
    every, system = sweep.table, sweep.build_system()
    steady = every["change"].values <= STEADY
    if not steady.any():
        raise MistakeError(f"{folder}: has no steady cycle, at none of its speeds; its friction has no mean")
    table = every.isel(speed=np.flatnonzero(steady))
    speed = table["speed"].values
    given = np.sum([table[f"{name}.mean_torque"].values for name in list_parts(system, Drive)], axis=0)
    torques, whole = dict[str, Vector](), given
    for loss in list_losses(system):
        torque = table[f"{loss.part}.{loss.figure}"].values / speed
        torques[loss.share] = torques.get(loss.share, 0.0) + torque
        whole = whole if loss.acts else whole + torque
    unsteady, outside = RPM * every["speed"].values[~steady], name_outside(list_losses(system))
    soft = list_soft(system, find_film_ratios(table.data_vars))
    return Sheet(folder.name, RPM * speed, torques, given, whole, unsteady, outside, soft)


def _list_shares(sheets: Sequence[Sheet]) -> list[str]:
    return [share for share in SHARES if any(share in sheet.torques for sheet in sheets)]


def _list_rows(sheets: Sequence[Sheet]) -> list[tuple[str, list[float]]]:
    """By design and speed: the speed, torque of each share, their sum, the drive's without and with all."""
    shares = _list_shares(sheets)
    return [
        (
            sheet.design,
            [
                *(sheet.speeds[i], *(float(sheet.torques[s][i]) for s in shares)),
                *(sheet.total[i], sheet.drive[i], sheet.whole[i]),
            ],
        )
        for sheet in sheets
        for i in range(len(sheet.speeds))
    ]


def tabulate_sheets(sheets: Sequence[Sheet]) -> Table:
    """Torques in mN m."""
    title, shares = "Friction torque on the drive (mN m), means over the cycle", _list_shares(sheets)
    heads = [head.replace(" ", "\n") for head in ("r/min", *shares, "sum", DRIVE, WHOLE)]
    table = make_table(title, ["design"], heads)
    for design, (speed, *torques) in _list_rows(sheets):
        table.add_row(design, f"{speed:.0f}", *(format_number(1e3 * torque, 3) for torque in torques))
    return table


def write_sheets(sheets: Sequence[Sheet], path: Path) -> None:
    """Torques in N m, powers in W."""
    shares = [*_list_shares(sheets), "sum", DRIVE, WHOLE]
    heads = [f"{share} [{unit}]" for unit in ("N.m", "W") for share in shares]
    rows = (
        [design, speed, *torques, *(torque * speed / RPM for torque in torques)]
        for design, (speed, *torques) in _list_rows(sheets)
    )
    path.parent.mkdir(parents=True, exist_ok=True)
    write_rows(path, [["design", "speed [r/min]", *heads], *rows])


def draw_shares(designs: Sequence[Sheet], title: str) -> Figure:
    """Torques (mN m) by share, stacked over speed: a panel for each design, and one of their sums."""
    count = len(designs) + (len(designs) > 1)
    columns = 2 if count == 4 else min(COLUMNS, count)
    title = f"{title}: friction torque on the drive over speed"
    size = (max(6.0, 3.6 * columns), 3.0)
    figure, panels = create_grid(count, columns, title, size, 0.8, sharex=True, sharey=True)
    shares = _list_shares(designs)
    hues = matplotlib.colormaps["tab10"](np.arange(len(SHARES)))
    colours = {share: hues[SHARES.index(share)] for share in shares}
    for panel, one in zip(panels, designs, strict=False):
        panel.set_title(one.design, loc="left")
        layers = [1e3 * one.torques[share] for share in shares]
        panel.stackplot(one.speeds, layers, colors=list(colours.values()), labels=shares, alpha=0.85)
        panel.plot(one.speeds, 1e3 * one.total, color="black", lw=1.0)
    if len(designs) > 1:
        sums = panels[len(designs)]
        sums.set_title("sums", loc="left")
        shades = matplotlib.colormaps["plasma"](np.linspace(0.0, 0.85, len(designs)))
        for shade, one in zip(shades, designs, strict=True):
            sums.plot(one.speeds, 1e3 * one.total, color=shade, marker="o", ms=3.0, label=one.design)
        sums.legend(loc="best", fontsize=7.5)
    for i, panel in enumerate(panels):
        panel.set_xlabel("Speed (r/min)")
        panel.set_ylim(bottom=0.0)
        if i % columns == 0:
            panel.set_ylabel("Torque (mN m)")
    handles, labels = panels[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=min(5, len(labels)))
    return figure
