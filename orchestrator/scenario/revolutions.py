"""Durations given as angles of a drive of constant speed."""

from collections.abc import Mapping
from contextlib import suppress
from dataclasses import replace
from typing import Any

from models.flywheel import PRESCRIBED

from .units import UnitError, is_bare, to_unit
from .values import Faults, build_component, parse_values, to_numbers

DRIVE = "flywheel"
DURATIONS = ("stop_time", "macro_step", "output_step")
REMEDY = (
    "the drive has no constant speed; give seconds, or one flywheel with motion = 'prescribed' and an "
    "initial_speed other than 0"
)


def convert_to_seconds(content: Mapping[str, Any]) -> dict[str, Any]:
    """The scenario's content with angles such as "2 revolutions" in seconds; Faults if no speed is known."""
    angles = {key: angle for key in DURATIONS if (angle := _parse_angle(content.get(key))) is not None}
    try:
        # Of twelve digits: 2 revolutions at 1000 r/min are 0.12 s exactly.
        return {
            **content,
            **{key: to_duration(angle, content) for key, angle in angles.items()},
        }
    except ArithmeticError:
        raise Faults(*((key, f" = {content[key]!r}: {REMEDY}") for key in angles)) from None


def to_duration(angle: float, content: Mapping[str, Any]) -> float:
    """Seconds in which the drive turns by the angle (rad), to twelve digits; ArithmeticError if its speed is
    unknown or not constant."""
    return float(f"{angle / find_speed(content):.12g}")


def _parse_angle(value: Any) -> float | None:
    """The angle in rad; None for other values."""
    if not isinstance(value, str) or is_bare(value):
        return None
    with suppress(UnitError):
        to_unit(value, "s")
        return None
    with suppress(UnitError):
        return to_unit(value, "rad")
    return None


def find_speed(content: Mapping[str, Any]) -> float:
    """The speed of the drive (rad/s); ArithmeticError if it is unknown or not constant."""
    components = content.get("components")
    tables = components.items() if isinstance(components, dict) else ()
    drives = [name for name, table in tables if isinstance(table, dict) and table.get("component") == DRIVE]
    if len(drives) != 1:
        raise ArithmeticError
    layout, table = build_component(DRIVE).parameters, content["components"][drives[0]].get("parameters", {})
    values = table.items() if isinstance(table, dict) else ()
    given = {name: value for name, value in values if name in layout and isinstance(value, int | float | str)}
    try:
        found = parse_values(layout, given, "parameter")
    except Faults as error:
        path = f"components.{drives[0]}.parameters."
        raise Faults(*(replace(one, place=path + one.place) for one in error.faults)) from None
    p = layout.named(layout.vector(to_numbers(layout, found)))
    if p["motion"] != PRESCRIBED or p["initial_speed"] != p["final_speed"] or p["initial_speed"] == 0.0:
        raise ArithmeticError
    return abs(p["initial_speed"])
