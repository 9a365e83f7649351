"""The figures of merit of a run in one table, with the angle, time and speed where each stands."""

import csv
import io
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from models.core.system import System

from ..scenario.display import format_number, show
from ..store import atomic_write
from .merits import Merit, Read
from .trains import Angle, find_angle, find_drive_angle

HEAD = ("part", "figure of merit", "value", "unit", "angle [deg]", "angle of", "time [ms]", "speed [r/min]")


def write_merits(system: System, merits: Sequence[Merit], read: Read, path: Path) -> None:
    """The table as a CSV file that a spreadsheet opens as it is."""
    text = io.StringIO()
    table = csv.writer(text)
    table.writerow(HEAD)
    drive = find_drive_angle(system)
    for merit in merits:
        shown = show(merit.quantity)
        place: list[str] = ["", "", "", ""]
        if merit.time is not None:
            angle = find_angle(system, merit.part)
            place = [
                *_place(angle, merit.time, read),
                f"{1e3 * merit.time:.6g}",
                _speed(drive, merit.time, read),
            ]
        words = merit.quantity.description
        value = format_number(shown.factor * merit.value, 6)
        table.writerow((merit.part, words, value, shown.text, *place))
    # Spreadsheets take a file for UTF-8 by its first three bytes.
    atomic_write.replace(path, text.getvalue().encode("utf-8-sig"))


def _place(angle: Angle | None, time: float, read: Read) -> tuple[str, str]:
    if angle is None:
        return "", ""
    turned = np.degrees(angle.factor * np.interp(time, read("time"), read(angle.source)))
    return f"{turned % 360.0:.2f}", angle.name.removesuffix("_angle")


def _speed(drive: Angle | None, time: float, read: Read) -> str:
    """Of the drive, r/min."""
    if drive is None:
        return ""
    times, angles = read("time"), read(drive.source)
    i = min(max(int(np.searchsorted(times, time)), 1), len(times) - 1)
    speed = (angles[i] - angles[i - 1]) / (times[i] - times[i - 1])
    return f"{30.0 / np.pi * speed:.5g}"
