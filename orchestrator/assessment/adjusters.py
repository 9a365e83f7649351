"""What is asked of a hydraulic lash adjuster: pressure, leak-down, check valve, pump-up."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING

import numpy as np

from models.core import roles
from models.core.quantities import Quantity, Vector
from models.core.words import tally

from ..scenario.display import format_number
from .lost_contact import LOST, ContactLaw, find_lost
from .motion import NONE, Figure, Found, Part
from .trains import find_rigid_lift

if TYPE_CHECKING:
    import xarray  # takes long to import

# A growth from turn to turn (m) that says nothing of a pump-up: the valve still rings on its seat.
RINGING = 0.5e-6
RPM = 30.0 / math.pi
# The lift (m) at which a valve opens and closes, as timings of cams are given.
OPENED = 1e-3
LENGTH = Quantity("m", display_unit="um")
ANGLE = Quantity("rad", display_unit="deg")


def _over_turn(find: Callable[[Part], Found]) -> Callable[[Part], Found]:
    """What is found in the last turn; of less than a turn nothing."""

    def found(part: Part) -> Found:
        if (turn := part.last_turn) is None:
            return NONE
        value, row = find(turn)
        return Found(value, None if row is None else row + part.motion.times.size - turn.motion.times.size)

    return found


def _move(turn: Part, flow: str) -> float:
    """By how much a flow (m3/s) of this turn moves the plunger (m)."""
    area = 0.25 * math.pi * turn.parameter("plunger_diameter") ** 2
    return turn.integrate(np.maximum(turn[flow], 0.0), turn.motion.times) / area


def _leave(part: Part) -> Found:
    """The largest gap beyond the plunger: bodies that it does not load (`ContactLaw`) may be off it."""
    beyond = part["upper_position"] - part["lower_position"] - part["extension"]
    gap = Found.largest(np.where(ContactLaw().judge(part["force"], beyond) == LOST, beyond, 0.0))
    return gap if gap.value > 0.0 else Found(0.0)


def _find_valve(turn: Part) -> Part | None:
    """The valve of its train, if it has a seat."""
    valves = turn.train.list_parts(roles.Valve) if turn.train else []
    seated = (Part(turn.motion, name) for name in valves)
    return next((valve for valve in seated if valve.parameter("seat_stiffness") > 0.0), None)


def _hold_open(turn: Part) -> Found:
    """The least lift of the valve in the turn."""
    valve = _find_valve(turn)
    return Found(max(0.0, -float(np.max(valve["seat_dip"])))) if valve else NONE


def _seat(turn: Part) -> Found:
    """Mean force of the seat where the cam does not lift."""
    valve = _find_valve(turn)
    if valve is None or turn.cam_lift is None:
        return NONE
    closed = turn.cam_lift <= 0.0
    return Found(float(np.mean(valve["seat_force"][closed]))) if closed.any() else NONE


def _find_lifts(turn: Part) -> tuple[Vector, Vector] | None:
    """Of the valve, and of the rigid train, as if the adjuster kept its length."""
    valve = _find_valve(turn)
    if valve is None or turn.train is None:
        return None
    return valve["valve_lift"], find_rigid_lift(turn.train, turn.motion.column)


def _lose_lift(turn: Part) -> Found:
    if (lifts := _find_lifts(turn)) is None:
        return NONE
    lift, rigid = lifts
    return Found(float(np.max(rigid) - np.max(lift)), int(np.argmax(lift)))


def _shift(closing: bool) -> Callable[[Part], Found]:
    """By which angle of the cam (rad) the valve passes OPENED after the rigid train; none of a turn that
    begins in a lift."""

    def find(turn: Part) -> Found:
        passed = []
        for lift in _find_lifts(turn) or ():
            rows = np.flatnonzero(lift > OPENED)
            if not rows.size or rows[0] == 0 or rows[-1] == lift.size - 1:
                return NONE
            row = rows[-1] if closing else rows[0] - 1
            share = (OPENED - lift[row]) / (lift[row + 1] - lift[row])
            passed.append(turn.turned[row] + share * (turn.turned[row + 1] - turn.turned[row]))
        return Found(float(passed[0] - passed[1]), int(row)) if passed else NONE

    return find


ADJUSTER: Mapping[str, Figure] = {
    "chamber_pressure": (
        Quantity("Pa", "highest pressure of the chamber, over the supply's", display_unit="MPa"),
        lambda part: Found.largest(part["pressure"]),
    ),
    "shortening": (
        LENGTH.of("largest shortening in a turn, by leak and compression"),
        _over_turn(lambda turn: Found.largest(turn["extension"][0] - turn["extension"])),
    ),
    "lift_loss": (
        LENGTH.of("largest lift of the rigid train less that of the valve, lost in a turn"),
        _over_turn(_lose_lift),
    ),
    "opening_shift": (
        ANGLE.of("by which the valve opens later than the rigid train, at 1 mm of lift"),
        _over_turn(_shift(closing=False)),
    ),
    "closing_shift": (
        ANGLE.of("by which the valve closes later than the rigid train, at 1 mm of lift; negative: earlier"),
        _over_turn(_shift(closing=True)),
    ),
    "leak_down": (
        LENGTH.of("sinking in a turn, by its leak"),
        _over_turn(lambda turn: Found(_move(turn, "leak_flow"))),
    ),
    "intake": (
        LENGTH.of("rise in a turn, by what the check valve lets in"),
        _over_turn(lambda turn: Found(_move(turn, "valve_flow"), int(np.argmax(turn["valve_flow"])))),
    ),
    "check_valve_open": (
        Quantity("1", "share of a turn in which the check valve is open", display_unit="%"),
        _over_turn(lambda turn: Found(turn.mean(turn["valve_flow"] > 0.0))),
    ),
    "growth": (
        LENGTH.of("growth from turn to turn"),
        _over_turn(lambda turn: Found(float(turn["extension"][-1] - turn["extension"][0]))),
    ),
    "held_open": (
        LENGTH.of("least lift of the valve in a turn, by which it is held open"),
        _over_turn(_hold_open),
    ),
    "seat_force_kept": (Quantity("N", "mean force of the seat on the base circle"), _over_turn(_seat)),
    "largest_extension": (
        LENGTH.of("largest length over that of the start"),
        lambda part: Found.largest(part["extension"]),
    ),
    "largest_gap": (LENGTH.of("largest gap between plunger and bodies that leave it"), _leave),
    "largest_gap_angle": (
        Quantity("rad", "cam angle of the largest gap", display_unit="deg"),
        lambda part: NONE if (row := _leave(part).row) is None else Found(part.angle[row] % (2.0 * math.pi)),
    ),
}
# What a sentence on bodies that leave the plunger ends with.
UNHELD = "no clip holds them, as one may in an engine"


def describe_growth(growth: float, held_open: float) -> str:
    """Whether an adjuster pumps up, by its growth from turn to turn and the valve's least lift (m)."""
    if held_open > 0.0:
        return f"has pumped up and holds the valve open by {_write(held_open)}"
    if growth > RINGING:
        return f"pumps up by {_write(growth)} in a turn"
    if growth < -RINGING:
        return f"sinks further by {_write(-growth)} from turn to turn"
    return "does not pump up"


def describe_over_speed(table: xarray.Dataset) -> list[str]:
    """A sentence on each adjuster of a sweep: pressure and leak where contact is kept, and the speeds at
    which its valve stays open."""
    said, rpm, lost = [], table["speed"].values * RPM, find_lost(table)
    for name in (str(n).rpartition(".")[0] for n in table.data_vars if str(n).endswith(".chamber_pressure")):
        figures = ("chamber_pressure", "leak_down", "held_open")
        pressure, leak, held = (table[f"{name}.{figure}"].values for figure in figures)
        texts = []
        if not lost.all():
            most, leaking = (int(np.nanargmax(np.where(lost, -np.inf, one))) for one in (pressure, leak))
            texts.append(
                f"{'where contact is kept, ' if lost.any() else ''}highest chamber pressure "
                f"{1e-6 * pressure[most]:.3g} MPa at {rpm[most]:.0f} r/min, largest leak in a turn "
                f"{_write(leak[leaking])} at {rpm[leaking]:.0f} r/min"
            )
        if (opened := np.flatnonzero(held > 0.0)).size:
            texts.append(
                f"pumped up, it holds the valve open at {tally(opened.size, 'speed')}, the lowest "
                f"{rpm[opened[0]]:.0f} r/min, by at most {_write(np.nanmax(held))}"
            )
        elif np.isfinite(held).all():
            texts.append("the valve closes at all speeds")
        gap, angle = (table[f"{name}.{figure}"].values for figure in ("largest_gap", "largest_gap_angle"))
        if (parted := np.flatnonzero(gap > 0.0)).size:
            widest = int(np.nanargmax(gap))
            texts.append(
                f"bodies leave its plunger at {tally(parted.size, 'speed')}, the lowest {rpm[parted[0]]:.0f} "
                f"r/min, by at most {_write(gap[widest])} at {rpm[widest]:.0f} r/min and "
                f"{math.degrees(angle[widest]):.1f} deg: {UNHELD}"
            )
        if texts:
            said.append(f"{name}: {'; '.join(texts)}")
    return said


def _write(length: float) -> str:
    return f"{format_number(1e6 * length, 3)} µm"
