"""Lift tables: files of cam angle and lift (`angle_table`), smoothed to the points of a cam profile.

Where the table says nothing the cam is round: its ends must then be on the base circle.
"""

from __future__ import annotations

import functools
import math
from dataclasses import dataclass, fields
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from models.core.quantities import Vector
from models.plausible import CAM_LIFT
from models.valve_train.cams.law import LawParameters
from models.valve_train.cams.table import TURN, TableParameters

from .angle_table import AngleTableError, Kind, read_angle_table
from .values import Faults

if TYPE_CHECKING:
    from models.valve_train.cams.smoothing import SmoothedLift

# A gap is longer than this many times the usual spacing.
GAP = 3.0
# Lifts up to this part of the largest are on the base circle.
ROUND = 1e-3
LIFT = Kind(
    "lift",
    "m",
    1,
    "the cam; for degrees of the crank write 'crank angle [deg]'",
    "angle [deg], lift [mm]",
    per_crank=0.5,
)


# Keys of a component's table that give a cam through points.
CAM_KEYS = frozenset({"lift_table", "lift_segments"})


@dataclass(frozen=True)
class LiftTable:
    """Samples of a lift: ascending angles (rad) within a turn, lifts (m), and the step (m) that they have."""

    angle: Vector
    lift: Vector
    rounding: float

    def smooth(self) -> SmoothedLift:
        """The smoothing spline over the turn, with a round cam in the gap."""
        from models.valve_train.cams.smoothing import smooth_lift  # its libraries take long to import

        angle, lift = self._close()
        try:
            return smooth_lift(angle, lift, self.rounding)
        except ValueError as error:
            raise AngleTableError(str(error)) from None

    def _close(self) -> tuple[Vector, Vector]:
        """The samples with those of the base circle, if the table leaves it out."""
        spacing = float(np.median(np.diff(self.angle)))
        gap = self.angle[0] + TURN - self.angle[-1]
        if gap <= GAP * spacing:
            return self.angle, self.lift
        ends = max(self.lift[0], self.lift[-1], key=abs)
        if abs(ends) > ROUND * self.lift.max():
            raise AngleTableError(
                f"the table ends at {math.degrees(self.angle[0]):g} and {math.degrees(self.angle[-1]):g} deg "
                f"with {1e3 * ends:g} mm of lift: continue it to the base circle, or over the whole turn"
            )
        count = round(gap / spacing)
        added = self.angle[-1] + gap / count * np.arange(1, count)
        return np.append(self.angle, added), np.append(self.lift, np.zeros(count - 1))


def read_lift_table(path: Path) -> LiftTable:
    """The samples of a file. AngleTableError that names the file, the line and the remedy."""
    angle, lift, rounding = read_angle_table(path, LIFT)
    if not lift.max() > 0.0:
        raise AngleTableError(f"{path}: its largest lift is {1e3 * lift.max():g} mm: must be > 0")
    if doubt := CAM_LIFT.reason * (not CAM_LIFT.holds(lift.max())):
        raise AngleTableError(
            f"{path}: its largest lift is {1e3 * lift.max():g} mm, but {doubt}; correct the header's unit"
        )
    return LiftTable(*_cut_at_a_turn(angle, lift), rounding)


@functools.lru_cache(maxsize=16)
def smooth_file(path: Path, changed: int) -> SmoothedLift:
    """The smoothed table of a file that was changed at this time (ns)."""
    table = read_lift_table(path)
    try:
        return table.smooth()
    except AngleTableError as error:
        raise AngleTableError(f"{path}: {error}") from None


# Lobes of valve trains, with long ramps, turn no further (rad).
LONGEST_EVENT = math.radians(240.0)
# Parameters of a law without its ramps, which a table replaces.
OF_LAWS = {field.name for field in fields(LawParameters)} - {field.name for field in fields(TableParameters)}


def insert_lift_table(table: dict[str, Any]) -> dict[str, Any]:
    """A component's table with the points of its `lift_table` among structure and parameters."""
    check_no_law(table, "lift_table")
    path = Path(table["lift_table"])
    changed = path.stat().st_mtime_ns if path.exists() else 0
    smoothed = smooth_file(path, changed)
    points, event = smoothed.points, dict(zip(("event_begin", "event_end"), smoothed.event, strict=True))
    rest = {key: value for key, value in table.items() if key != "lift_table"}
    return rest | {
        "structure": {**table.get("structure", {}), "table_points": points.angle.size},
        "parameters": {**points.parameters(), **event, **table.get("parameters", {})},
    }


def replace_law(table: dict[str, Any], key: str) -> None:
    """Take other cams out of a component's table that gets this one of CAM_KEYS."""
    for other in CAM_KEYS - {key}:
        table.pop(other, None)
    parameters = table.get("parameters")
    if isinstance(parameters, dict):
        table["parameters"] = {name: value for name, value in parameters.items() if name not in OF_LAWS}


def doubt_cam(begin: float, end: float, lifts: Vector) -> str:
    """Why a cam through points is doubtful that lifts between these angles (rad); "" if it isn't."""
    if abs(lifts.min()) > ROUND * lifts.max():
        return (
            f"its least lift is {1e3 * lifts.min():.3g} mm: lifts count from the base circle; subtract it "
            "from all lifts of the table"
        )
    if end - begin <= LONGEST_EVENT:
        return ""
    turned = math.degrees(end - begin)
    return f"the cam lifts over {turned:.4g} deg: name the crank's angles 'crank angle [deg]' in the table"


def check_no_law(table: dict[str, Any], key: str) -> None:
    """Refuse parameters of a law beside this key."""
    for name in table.get("parameters", {}):
        if name in OF_LAWS:
            raise Faults((f"parameters.{name}", f": has no meaning beside {key}; leave one of them out"))


def _cut_at_a_turn(angle: Vector, lift: Vector) -> tuple[Vector, Vector]:
    """Without the last sample where it repeats the first one a turn later."""
    repeated = angle[-1] - angle[0] > TURN * (1.0 - 1e-9)
    return (angle[:-1], lift[:-1]) if repeated else (angle, lift)
