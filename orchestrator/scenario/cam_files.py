"""Files that cam designers and grinders exchange: lift tables, contours, and `.s96`.

An `.s96` file has one lift to a line for each degree of the cam, with 8 decimals, here in inches: 360 from
the base circle opposite to the nose on, then the first 36 again (as L&M Engines describe Harvey Crane's
format).
"""

import math
from collections.abc import Callable
from pathlib import Path

import numpy as np
import scipy

from models.core.quantities import Vector
from models.core.words import tally
from models.valve_train.cams.table import TURN
from models.valve_train.followers.shape import CamShape

from ..texts import read_bytes
from .angle_table import AngleTableError, Kind, decode, read_angle_table, read_lines

INCH, MM = 0.0254, 1e3
DEGREES, AGAIN, DECIMALS = 360, 36, 8
S96 = ".s96"
# Rows that are there again agree within this many steps of the last decimal.
AGREED = 10.0
RADIUS = Kind(
    "radius", "m", 1, "the cam", "angle [deg], radius [mm]", per_crank=0.5, names=("radius", "r"), guess="mm"
)


def write_s96(lift: Callable[[float], float], nose: float) -> str:
    """Of a lift (m) of the cam angle (rad) with its nose there."""
    angles = nose - math.pi + np.radians(np.arange(DEGREES + AGAIN) % DEGREES)
    return "".join(f"{_format(lift(a % TURN) / INCH, DECIMALS)}\n" for a in angles)


def _format(value: float, decimals: int) -> str:
    """The rounded value; a small negative one is 0, not -0."""
    return f"{round(value, decimals) + 0.0:.{decimals}f}"


def read_s96(path: Path) -> tuple[Vector, Vector, float]:
    """Angles (rad), lifts (m) and their step; the nose is at pi. AngleTableError for another file."""
    lines = [line.strip() for _, line in read_lines(path, "an .s96 file has one lift in inches to a line")]
    if len(lines) != DEGREES + AGAIN:
        raise AngleTableError(
            f"{path}: has {tally(len(lines), 'line')}; an .s96 file has {DEGREES + AGAIN} lifts"
        )
    lifts = np.empty(len(lines))
    for i, line in enumerate(lines):
        try:
            lifts[i] = float(line)
        except ValueError:
            lifts[i] = math.nan
        if not math.isfinite(lifts[i]):
            raise AngleTableError(f"{path}: line {i + 1}, {line[:40]!r}: must be one lift in inches")
    apart = np.abs(lifts[DEGREES:] - lifts[:AGAIN])
    if apart.max() > AGREED * 10.0**-DECIMALS:
        i = int(np.argmax(apart))
        written = lines[DEGREES + i]
        raise AngleTableError(
            f"{path}: line {DEGREES + i + 1}, {written!r}: must repeat line {i + 1}, {lines[i]!r}"
        )
    return np.radians(np.arange(DEGREES)), INCH * lifts[:DEGREES], INCH * 10.0**-DECIMALS


def write_lift(lift: Callable[[float], float], unit: str) -> str:
    """A lift table that `lift_table` reads, for each degree of the cam; `unit` is mm or in."""
    size, decimals = (MM, 6) if unit == "mm" else (1.0 / INCH, 8)
    angles = np.arange(DEGREES)
    rows = (f"{a},{_format(size * lift(math.radians(a)), decimals)}" for a in angles)
    return "\n".join([f"cam angle [deg],lift [{unit}]", *rows, ""])


def write_contour(x: Vector, y: Vector) -> str:
    """Polar angles clockwise from y, as the cam angle goes, with radii and coordinates."""
    angle, radius = np.degrees(np.arctan2(x, y)) % 360.0, np.hypot(x, y)
    columns = np.column_stack([angle, MM * radius, MM * x, MM * y])[np.argsort(angle)]
    rows = (",".join(f"{value:.9f}" for value in row) for row in columns)
    return "\n".join(["cam angle [deg],radius [mm],x [mm],y [mm]", *rows, ""])


def is_contour(path: Path) -> bool:
    """Whether the first line of a file names a radius."""
    if not path.is_file():
        return False
    lines = decode(read_bytes(path)).splitlines()
    head = next((line for line in lines if not line.startswith("#")), "")
    return "radius" in head.casefold()


def read_contour(path: Path) -> CamShape:
    """The shape through polar angles and radii: a periodic spline of the radius. AngleTableError for another
    file."""
    found = read_angle_table(path, RADIUS)
    angle, radius = found.angle, found.value
    if angle[-1] - angle[0] >= TURN * (1.0 - 1e-9):
        angle, radius = angle[:-1], radius[:-1]
    steps = np.diff(angle, append=angle[0] + TURN)
    if not radius.min() > 0.0 or steps.max() > math.radians(5.0):
        raise AngleTableError(
            f"{path}: must have radii > 0 all around, 5 deg apart at most; the widest gap is "
            f"{math.degrees(steps.max()):.4g} deg, the least radius {MM * radius.min():.4g} mm"
        )
    spline = scipy.interpolate.CubicSpline(
        np.append(angle, angle[0] + TURN), np.append(radius, radius[0]), bc_type="periodic"
    )
    r, slope, bend = spline(angle), spline(angle, 1), spline(angle, 2)
    sine, cosine, speed = np.sin(angle), np.cos(angle), np.hypot(r, slope)
    return CamShape(
        r * sine,
        r * cosine,
        (r * sine - slope * cosine) / speed,
        (r * cosine + slope * sine) / speed,
        speed**3 / (r**2 + 2.0 * slope**2 - r * bend),
    )
