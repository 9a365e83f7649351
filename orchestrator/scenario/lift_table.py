"""Lift tables: files of cam angle and lift (`angle_table`), smoothed to the points of a cam profile.

Where the table says nothing the cam is round: both ends of a gap must then be on the base circle.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Sequence
from dataclasses import dataclass, fields
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, NoReturn

import numpy as np
from pydantic import Field, ValidationError

from models.core.quantities import Vector
from models.plausible import CAM_LIFT
from models.valve_train.cams.law import LawParameters
from models.valve_train.cams.ramps import RampParameters
from models.valve_train.cams.segments import Rise, join_sides, scale_rise
from models.valve_train.cams.table import TURN, Points, TableParameters

from .angle_table import AngleTable, AngleTableError, Kind, find_gaps, read_angle_table
from .cam_files import INCH, S96, read_s96
from .fields import Table, in_unit
from .messages import place_faults
from .units import to_unit
from .values import WARNING, Faults, Inserted

if TYPE_CHECKING:
    from models.valve_train.cams.smoothing import SmoothedLift

# A base circle, and a row from its neighbours, is off by no more than this part of the largest lift.
OFF = 0.02
# Lifts up to this part of the largest are on the base circle.
ROUND = 1e-3
# Cams of valve trains lift over 100 to 150 deg without ramps, and over 75 to 115 deg above a tenth of their
# lift, where ramps are over. From here on (rad) the angles may be those of the crank.
LONGEST_LOBE = math.radians(140.0)
# A base circle's radius is more than this part of the nose's; a table of lifts goes down to its base circle.
RADII = 0.5
# An acceleration that may be off by more than this part of its largest value is doubted.
UNCERTAIN = 0.05
# A row that is off the median of five by more than so many largest medians is wrong.
SLIP = 2.0
# Steps of gauges (m), longest first: 1, 2 and 5 of a decimal of mm and inch. So many different lifts tell it.
STEPS = np.sort(np.outer([1e-3, INCH], np.outer([1.0, 2.0, 5.0], 10.0 ** -np.arange(1, 7))).ravel())[::-1]
MANY = 12
LIFT = Kind(
    "lift",
    "m",
    1,
    "the cam; for degrees of the crank write 'crank angle [deg]'",
    "angle [deg], lift [mm]",
    per_crank=0.5,
    names=(
        *("lift", "hub", "ventilhub", "levée", "levee", "alzata", "levant", "alzad", "stroke", "valve"),
        *("lyft", "heff"),
    ),
    guess="mm",
)


# Keys of a component's table that give a cam through points.
CAM_KEYS = frozenset({"lift_table", "lift_segments"})


@dataclass(frozen=True)
class LiftTable:
    """Samples of a lift: ascending angles (rad) within a turn, lifts (m), and the step (m) that they have.

    `notes`: what was chosen in reading. `named`: the file says whose angles it has.
    """

    angle: Vector
    lift: Vector
    rounding: float
    notes: tuple[str, ...] = ()
    named: bool = False

    def smooth(self) -> SmoothedLift:
        """The smoothing spline over the turn, with a round cam in gaps of the base circle."""
        from models.valve_train.cams.smoothing import smooth_lift  # its libraries take long to import

        angle, lift, _ = self._fill_gaps()
        try:
            smoothed = smooth_lift(angle, lift, self.rounding)
        except ValueError as error:
            raise AngleTableError(str(error)) from None
        if smoothed.doubtful:
            self._check_row(*smoothed.doubtful)
        near = np.median([np.roll(self.lift, k) for k in range(-2, 3)], axis=0)
        off = self.lift - near
        i = int(np.argmax(np.abs(off)))
        if abs(off[i]) > SLIP * near.max():  # of two wrong rows each bears out the other
            self._refuse_row(self.angle[i], off[i], near.max())
        return smoothed

    def _check_row(self, angle: float, deviation: float) -> None:
        """Refuse the row at this angle where it is off the others by more than a cam may be."""
        largest = float(self.lift[self.angle != angle].max())
        if abs(deviation) > OFF * largest:
            self._refuse_row(angle, deviation, largest)

    def _refuse_row(self, angle: float, deviation: float, largest: float) -> NoReturn:
        value = 1e3 * self.lift[np.argmin(np.abs(self.angle - angle))]
        raise AngleTableError(
            f"the row at {math.degrees(angle):.5g} deg lifts by {value:.6g} mm, {1e3 * deviation:.3g} mm "
            f"off the others, which lift by at most {1e3 * largest:.4g} mm: correct it"
        )

    def _fill_gaps(self) -> tuple[Vector, Vector, list[str]]:
        """The samples with those of the base circle where rows are missing, and what is missing."""
        spacing = float(np.median(np.diff(self.angle, append=self.angle[0] + TURN)))
        added, notes = [], []
        for gap in find_gaps(self.angle, TURN):
            first, last = float(self.lift[gap.i]), float(self.lift[(gap.i + 1) % self.angle.size])
            if max(abs(first), abs(last)) <= max(ROUND * self.lift.max(), 1.01 * self.rounding):
                count = round(gap.length / spacing)
                share = np.arange(1, count) / max(count, 1)
                added.append((gap.begin + gap.length * share, first + (last - first) * share))
                notes.append(f"no rows {gap.place}: the cam is round there")
            elif gap.i == self.angle.size - 1 or gap.wide:
                remedy = "add them, or continue the table to the base circle"
                if self.lift.min() > RADII * self.lift.max():
                    remedy = f"if these are radii, subtract the base circle's from all rows; else {remedy}"
                raise AngleTableError(
                    f"rows are missing {gap.place}, where it lifts by {1e3 * first:g} and {1e3 * last:g} mm: "
                    + remedy
                )
            else:
                notes.append(f"rows are missing {gap.place}: the lift there is interpolated")
        angle, lift = (
            np.concatenate([own, *more])
            for own, more in zip(
                (self.angle, self.lift), zip(*added, strict=True) if added else ((), ()), strict=True
            )
        )
        angle = np.where(angle >= self.angle[0] + TURN, angle - TURN, angle)
        order = np.argsort(angle)
        return angle[order], lift[order], notes

    def list_notes(self) -> list[str]:
        """What was chosen in reading."""
        return [*self.notes, *self._fill_gaps()[2]]

    def list_doubts(self, smoothed: SmoothedLift, ramp_height: float = 0.0) -> list[str]:
        """What may be wrong with the table, to which ramps of this height (m) are added."""
        shape = _doubt_zero(smoothed)
        shape = shape or ("" if self.named else _doubt_event(smoothed)) or _doubt_runout(smoothed)
        ramps = _doubt_ramps(smoothed.ramp, ramp_height)
        return [doubt for doubt in (shape, ramps, self._doubt_accuracy(smoothed)) if doubt]

    def _doubt_accuracy(self, smoothed: SmoothedLift) -> str:
        share = smoothed.curvature_error / float(np.abs(smoothed.points.curvature).max())
        doubt = (
            f"the acceleration may be off by {100.0 * share:.0f} % of its largest value, and so may the "
            "force of inertia in loads, pressures, spring margin and speed of separation"
        )
        doubt *= share > UNCERTAIN
        if smoothed.doubtful:
            angle, deviation = smoothed.doubtful
            row = f"the row at {math.degrees(angle):.5g} deg is {1e3 * deviation:.3g} mm off the others"
            return f"{row}{doubt and ', and '}{doubt}; correct it"
        if not doubt:
            return ""
        rows = math.degrees(float(np.median(np.diff(self.angle))))
        return (
            f"with rows each {rows:.3g} deg and lifts in steps of {_name_step(self.rounding)} {doubt}; "
            "take more rows, or more digits"
        )


def _doubt_zero(smoothed: SmoothedLift) -> str:
    (low, high), lift = smoothed.base_circle, smoothed.points.lift
    if abs(lift.min()) <= ROUND * lift.max():
        return ""
    if max(abs(low), abs(high)) <= OFF * lift.max() and abs(low + high) <= 4.0 * (high - low):
        return ""
    return (
        f"its least lift is {1e3 * lift.min():.3g} mm: lifts count from the base circle; subtract it from "
        "all lifts of the table"
    )


def _doubt_runout(smoothed: SmoothedLift) -> str:
    (low, high), largest = smoothed.base_circle, float(smoothed.points.lift.max())
    off = max(abs(low), abs(high))
    if off <= max(ROUND * largest, 3.0 * smoothed.noise) or off > OFF * largest:
        return ""
    return (
        f"its base circle has a runout of {1e3 * (high - low):.3g} mm, which moves the follower; the event "
        f"counts from a lift of {1e3 * smoothed.event_height:.3g} mm"
    )


def _doubt_ramps(own: float, added: float) -> str:
    if not (own and added):
        return ""
    return (
        f"it has a ramp itself, up to {1e3 * own:.2g} mm, to which `ramp_height` adds {1e3 * added:.3g} mm: "
        "set ramp_height = 0, or take the ramps out of the table"
    )


def _doubt_event(smoothed: SmoothedLift) -> str:
    if smoothed.lobe <= LONGEST_LOBE:
        return ""
    event, lobe = math.degrees(smoothed.event[1] - smoothed.event[0]), math.degrees(smoothed.lobe)
    return (
        f"the cam lifts over {event:.4g} deg, over {lobe:.4g} deg above a tenth of its lift, as cam angles: "
        "if they are the crank's, name them 'crank angle [deg]' in the table, else 'cam angle [deg]'"
    )


def read_lift_table(path: Path) -> LiftTable:
    """The samples of a file. AngleTableError that names the file, the line and the remedy."""
    if path.suffix.casefold() == S96:
        angle, lift, step = read_s96(path)
        found = AngleTable(angle, lift, step, (), True)
    else:
        found = read_angle_table(path, LIFT)
    angle, lift = found.angle, found.value
    if lift.mean() <= 0.0:
        raise AngleTableError(
            f"{path}: its lifts are from {1e3 * lift.min():g} to {1e3 * lift.max() + 0.0:g} mm: must rise "
            "above 0 from the base circle; change their sign, or subtract the base circle's from all of them"
        )
    if doubt := CAM_LIFT.reason * (not CAM_LIFT.holds(lift.max())):
        at = math.degrees(angle[np.argmax(lift)])
        raise AngleTableError(
            f"{path}: its largest lift is {1e3 * lift.max():g} mm, at {at:.5g} deg, but {doubt}; correct the "
            "header's unit, or this row"
        )
    step = _find_step(lift, found.rounding)
    try:
        angle, lift = _cut_at_a_turn(angle, lift, step)
    except AngleTableError as error:
        raise AngleTableError(f"{path}: {error}") from None
    return LiftTable(angle, lift, step, found.notes, found.named)


def _find_step(lift: Vector, written: float) -> float:
    """The step (m) of the lifts: the longest of STEPS whose multiples they are as written, else that of
    their last decimal."""
    steps = STEPS[1.9 * written < STEPS] if np.unique(lift).size >= MANY else STEPS[:0]
    found = (s for s in steps.tolist() if np.abs(lift - s * np.round(lift / s)).max() < 0.51 * written)
    return next(found, written)


def _name_step(step: float) -> str:
    """In mm, and in inches of which it is a round part."""
    inches = step / INCH
    known = f" ({inches:g} in)" if math.isclose(inches, float(f"{inches:.0e}"), rel_tol=1e-6) else ""
    return f"{1e3 * step:.3g} mm{known}"


def smooth_file(path: Path) -> tuple[LiftTable, SmoothedLift]:
    """The table of a file, and it smoothed, which is kept as long as the file is not changed."""
    return _smooth_file(path, path.stat().st_mtime_ns if path.exists() else 0)


@functools.lru_cache(maxsize=16)
def _smooth_file(path: Path, changed: int) -> tuple[LiftTable, SmoothedLift]:
    table = read_lift_table(path)
    try:
        return table, table.smooth()
    except AngleTableError as error:
        raise AngleTableError(f"{path}: {error}") from None


# Parameters of a law alone, and those of the ramps that a law and a table may have.
RAMPS = {field.name for field in fields(RampParameters)}
OF_LAWS = {field.name for field in fields(LawParameters)} - {field.name for field in fields(TableParameters)}


def insert_lift_table(table: dict[str, Any]) -> Inserted:
    """The points of the table's `lift_table`."""
    check_no_law(table, "lift_table")
    read, smoothed = smooth_file(Path(table["lift_table"]))
    doubts = read.list_doubts(
        smoothed, _find_ramp_height(table.get("parameters", {}).get("ramp_height", 0.0))
    )
    notes = [*read.list_notes(), *(WARNING + doubt for doubt in doubts)]
    return _insert_points(smoothed.points, smoothed.event, notes)


def _find_ramp_height(given: Any) -> float:
    """In m; 0 for what the check of the parameters refuses."""
    try:
        return to_unit(given, "m") if isinstance(given, str) else float(given)
    except (TypeError, ValueError):
        return 0.0


def _insert_points(points: Points, event: tuple[float, float], notes: Sequence[str] = ()) -> Inserted:
    ends = {"event_begin": event[0], "event_end": event[1]}
    return Inserted({**points.parameters(), **ends}, {"table_points": points.angle.size}, notes)


def replace_law(table: dict[str, Any], key: str) -> None:
    """Take other cams out of a component's table that gets this one of CAM_KEYS: a law with its ramps."""
    gone = OF_LAWS if CAM_KEYS & table.keys() else OF_LAWS | RAMPS
    for other in CAM_KEYS - {key}:
        table.pop(other, None)
    parameters = table.get("parameters")
    if isinstance(parameters, dict):
        table["parameters"] = {name: value for name, value in parameters.items() if name not in gone}


def check_no_law(table: dict[str, Any], key: str) -> None:
    """Refuse parameters of a law beside this key."""
    for name in table.get("parameters", {}):
        if name in OF_LAWS:
            raise Faults((f"parameters.{name}", f": has no meaning beside {key}; leave one of them out"))


def _cut_at_a_turn(angle: Vector, lift: Vector, rounding: float) -> tuple[Vector, Vector]:
    """Without the last sample where it repeats the first one a turn later."""
    if angle[-1] - angle[0] <= TURN * (1.0 - 1e-9):
        return angle, lift
    if abs(lift[-1] - lift[0]) > max(ROUND * lift.max(), 1.01 * rounding):
        raise AngleTableError(
            f"begins with a lift of {1e3 * lift[0]:g} mm and ends, a turn later, with {1e3 * lift[-1]:g} mm: "
            "must agree"
        )
    return angle[:-1], lift[:-1]


Angle = Annotated[float, in_unit("rad", zero=True)]
Side = list[tuple[Angle, float]]
EXAMPLE = '[["0 deg", 0], ["12 deg", 1], ["24 deg", 1], ["34 deg", -0.3], ["65 deg", -0.4]]'


class LiftSegments(Table):
    """Accelerations at angles from the foot of the cam, straight lines between them."""

    lift: Annotated[float, in_unit("m")] = Field(description="Lift (m)")
    rise: Side = Field(
        description="Rows of angle from the opening's foot and relative acceleration", min_length=3
    )
    fall: Side | None = Field(
        None, description="The same from the closing's foot; left out: as the rise", min_length=3
    )
    dwell: Angle = Field(0.0, description="Angle of the dwell at the nose (rad)")
    nose: Angle = Field(math.pi, description="Cam angle of the nose (rad)")


def insert_lift_segments(table: dict[str, Any]) -> Inserted:
    """The points of the table's `lift_segments`."""
    check_no_law(table, "lift_segments")
    try:
        given = LiftSegments.model_validate(table["lift_segments"])
    except ValidationError as error:
        raise place_faults("lift_segments", error, list(LiftSegments.model_fields)) from None
    rise = _scale("rise", given.rise, given.lift)
    fall = _scale("fall", given.fall, given.lift) if given.fall else rise
    try:
        points = join_sides(rise, fall, given.nose, given.dwell)
    except ValueError as error:
        raise Faults(("lift_segments", f": {error}")) from None
    turned = points.angle[-1] - points.angle[0]
    if turned > 2.0 * math.pi:
        raise Faults(("lift_segments", f": spans {math.degrees(turned):.4g} deg: must be at most 360 deg"))
    return _insert_points(points, (float(points.angle[0]), float(points.angle[-1])))


def _scale(name: str, rows: Side, lift: float) -> Rise:
    angle, acceleration = np.array(rows).T
    if angle[0] != 0.0 or acceleration[0] != 0.0 or not np.all(np.diff(angle) > 0.0):
        raise Faults(
            (
                f"lift_segments.{name}",
                f": must begin with angle and acceleration 0, and ascend; e.g. {EXAMPLE}",
            )
        )
    try:
        return scale_rise(angle, acceleration, lift)
    except ValueError as error:
        raise Faults((f"lift_segments.{name}", f": {error}")) from None


def format_lifts(points: Points) -> str:
    """A lift table, of which the lift is that of these points within 1e-10 m."""
    rows = (f"{math.degrees(a):.9g}, {1e3 * s:.7f}\n" for a, s in zip(points.angle, points.lift, strict=True))
    return "cam angle [deg], lift [mm]\n" + "".join(rows)
