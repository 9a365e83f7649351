"""What is asked of a hydraulic lash adjuster: pressure, leak-down, check valve, pump-up."""

import math
from collections.abc import Callable, Mapping

import numpy as np
import xarray

from models.core import roles
from models.core.quantities import Quantity, Vector
from models.core.words import tally

from ..scenario.display import format_number
from .lost_contact import find_lost
from .motion import Found, Part

# A growth from turn to turn (m) that says nothing of a pump-up: the valve still rings on its seat.
RINGING = 0.5e-6
# The last rows within this of a turn (rad) are one.
SLACK = math.radians(3.6)
RPM = 30.0 / math.pi
ROUNDING = 1e-9
NONE = Found(math.nan)
LENGTH = Quantity("m", display_unit="um")


def _find_turn(part: Part) -> slice | None:
    """The rows of the cam's last whole turn; None where there is none."""
    begin = part.angle[-1] - 2.0 * math.pi
    if not part.angle[0] <= begin + SLACK:
        return None
    return slice(max(0, int(np.searchsorted(part.angle, begin + ROUNDING)) - 1), None)


def _over_turn(find: Callable[[Part, slice], Found]) -> Callable[[Part], Found]:
    """What is found in the last turn, by its first row; of less than a turn nothing."""

    def found(part: Part) -> Found:
        turn = _find_turn(part)
        if turn is None:
            return NONE
        value, row = find(part, turn)
        return Found(value, None if row is None else row + turn.start)

    return found


def _move(part: Part, turn: slice, flow: Vector) -> float:
    """By how much a flow (m3/s) of this turn moves the plunger (m)."""
    area = 0.25 * math.pi * part.parameter("plunger_diameter") ** 2
    return float(np.trapezoid(np.maximum(flow[turn], 0.0), part.motion.times[turn])) / area


def _shorten(part: Part, turn: slice) -> Found:
    shorter = part["extension"][turn.start] - part["extension"][turn]
    return Found(float(np.max(shorter)), int(np.argmax(shorter)))


def _take_in(part: Part, turn: slice) -> Found:
    flow = part["valve_flow"]
    return Found(_move(part, turn, flow), int(np.argmax(flow[turn])))


def _stay_open(part: Part, turn: slice) -> Found:
    opened, times = (part["valve_flow"][turn] > 0.0).astype(float), part.motion.times[turn]
    return Found(float(np.trapezoid(opened, times) / (times[-1] - times[0])))


def _grow(part: Part, turn: slice) -> Found:
    return Found(float(part["extension"][-1] - part["extension"][turn.start]))


def _find_valve(part: Part) -> Part | None:
    """The valve of its train, if it has a seat."""
    valves = part.train.list_parts(roles.Valve) if part.train else []
    seated = (Part(part.motion, name) for name in valves)
    return next((valve for valve in seated if valve.parameter("seat_stiffness") > 0.0), None)


def _hold_open(part: Part, turn: slice) -> Found:
    """The least lift of the valve in the turn."""
    valve = _find_valve(part)
    return Found(max(0.0, -float(np.max(valve["seat_dip"][turn])))) if valve else NONE


def _seat(part: Part, turn: slice) -> Found:
    """Mean force of the seat where the cam does not lift."""
    valve = _find_valve(part)
    if valve is None or part.cam_lift is None:
        return NONE
    closed = part.cam_lift[turn] <= 0.0
    return Found(float(np.mean(valve["seat_force"][turn][closed]))) if closed.any() else NONE


ADJUSTER: Mapping[str, tuple[Quantity, Callable[[Part], Found]]] = {
    "chamber_pressure": (
        Quantity("Pa", "highest pressure of the chamber, over the supply's", display_unit="MPa"),
        lambda part: Found(float(np.max(part["pressure"])), int(np.argmax(part["pressure"]))),
    ),
    "shortening": (LENGTH.of("largest shortening in a turn, by leak and compression"), _over_turn(_shorten)),
    "leak_down": (
        LENGTH.of("sinking in a turn, by its leak"),
        _over_turn(lambda part, turn: Found(_move(part, turn, part["leak_flow"]))),
    ),
    "intake": (LENGTH.of("rise in a turn, by what the check valve lets in"), _over_turn(_take_in)),
    "check_valve_open": (
        Quantity("1", "share of a turn in which the check valve is open", display_unit="%"),
        _over_turn(_stay_open),
    ),
    "growth": (LENGTH.of("growth from turn to turn"), _over_turn(_grow)),
    "held_open": (
        LENGTH.of("least lift of the valve in a turn, by which it is held open"),
        _over_turn(_hold_open),
    ),
    "seat_force_kept": (
        Quantity("N", "mean force of the seat on the base circle"),
        _over_turn(_seat),
    ),
    "largest_extension": (
        LENGTH.of("largest length over that of the start"),
        lambda part: Found(float(np.max(part["extension"])), int(np.argmax(part["extension"]))),
    ),
}


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
        if texts:
            said.append(f"{name}: {'; '.join(texts)}")
    return said


def _write(length: float) -> str:
    return f"{format_number(1e6 * length, 3)} µm"
