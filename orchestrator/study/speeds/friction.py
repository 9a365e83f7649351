"""Friction of whole trains over speed by shares, of a sweep or of several designs such as temperatures."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from rich import box
from rich.table import Table

from models.core.quantities import Vector
from models.core.roles import Drive
from models.monolithic.cycle import STEADY

from ...assessment.friction.losses import SHARES, list_losses, name_outside
from ...assessment.trains import list_parts
from ...errors import MistakeError
from ...scenario.display import format_number
from ...store.csv_file import write_rows
from ...store.output_folder import STORE, SUMMARY
from .compare import read_sweep

RPM = 30.0 / math.pi
DRIVE, WHOLE = "drive", "drive with all friction"


@dataclass(frozen=True)
class Sheet:
    """A design's speeds (r/min) of the drive, and mean torques (N m) on it by share; what the drive gives;
    `whole` has the friction outside the motion too.

    `unsteady` are speeds at which no steady cycle was found: they have no means and are left out. `outside`
    names the friction that what the drive gives does not contain.
    """

    design: str
    speeds: Vector
    torques: dict[str, Vector]
    drive: Vector
    whole: Vector
    unsteady: Vector
    outside: str

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
    return Sheet(folder.name, RPM * speed, torques, given, whole, unsteady, outside)


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
    table = Table(
        title="Friction torque on the drive (mN m), means over the cycle", title_justify="left",
        box=box.SIMPLE_HEAD, pad_edge=False,
    )  # fmt: skip
    table.add_column("design")
    for head in ("r/min", *_list_shares(sheets), "sum", DRIVE, WHOLE):
        table.add_column(head, justify="right")
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
