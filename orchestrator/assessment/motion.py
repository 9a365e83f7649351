"""The parts of a motion, and what is found of them."""

import math
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from models.core import roles
from models.core.component import Component
from models.core.quantities import Quantity, Vector
from models.core.system import System

from .trains import (
    OPEN,
    Angle,
    Train,
    count_gas_turns,
    find_lost_rows,
    find_train,
    find_trains,
    list_parts,
    parameter_of,
)


class Found(NamedTuple):
    """A value (nan: the part has none), and the row where it stands (None: it is of all rows)."""

    value: float
    row: int | None = None

    @classmethod
    def at(cls, values: Vector, row: int | np.intp) -> "Found":
        return cls(float(values[row]), int(row))

    @classmethod
    def largest(cls, values: Vector) -> "Found":
        return cls.at(values, np.argmax(values))


NONE = Found(math.nan)
# The last rows within this of a turn (rad) are one.
SLACK = 2.0 * math.pi * OPEN
ROUNDING = 1e-9
# Of its largest lift: from here on a cam is at its nose.
NEAR = 1.0 - 1e-3
RUN = "the run"


@dataclass(frozen=True)
class Motion:
    """Rows of a system: their times (s), inputs and outputs by "instance.variable", and the angle over which
    parts are read that no cam moves."""

    system: System
    times: Vector
    column: Callable[[str], Vector]
    angle: Angle | None

    @cached_property
    def cycle(self) -> float:
        """Revolutions in a cycle: one of a cam, else those of the gas, else one."""
        gases = [] if find_trains(self.system) else list_parts(self.system, roles.CylinderGas)
        return max((count_gas_turns(self.system.instances[name]) for name in gases), default=1.0)

    @cached_property
    def turned(self) -> Vector:
        """Cycles of the first cam, else of `angle`, since the first row, either way; nan without any."""
        angle = next((train.angle for train in find_trains(self.system)), self.angle)
        turned = angle.factor * self.column(angle.source) if angle else np.nan * self.times
        return np.asarray(np.abs(turned - turned[0]) / (2.0 * math.pi * self.cycle))

    @cached_property
    def turns(self) -> int:
        """Whole cycles that the rows hold."""
        return math.floor(np.nan_to_num(self.turned[-1]) + OPEN)

    @cached_property
    def begin(self) -> float:
        """When the last of these begin (s), from where on means are taken: of none at the first row."""
        before = self.turned[-1] - self.turns
        return float(np.interp(before, self.turned, self.times) if self.turns else self.times[0])

    @property
    def window(self) -> str:
        """Over what means are taken, in words."""
        rest = self.turned[-1] - self.turns
        one, several = "revolution", "revolutions"
        if self.cycle > 1.0:
            one, several = (f"{word} of {self.cycle:g} revolutions" for word in ("cycle", "cycles"))
        if self.turns and rest > OPEN:
            return f"its last {self.turns} {several}" if self.turns > 1 else f"its last {one}"
        return RUN if self.turns or np.isnan(rest) else f"{RUN}, which is less than a {one}"

    def cut(self, first: int) -> "Motion":
        """The rows from this one on."""
        return replace(self, times=self.times[first:], column=lambda name: self.column(name)[first:])


@dataclass(frozen=True)
class Part:
    """A part in a motion: its variables by their own names."""

    motion: Motion
    name: str
    _columns: dict[str, Vector] = field(default_factory=dict)

    def __getitem__(self, variable: str) -> Vector:
        if variable not in self._columns:
            self._columns[variable] = self.motion.column(f"{self.name}.{variable}")
        return self._columns[variable]

    @property
    def component(self) -> Component:
        return self.motion.system.instances[self.name].component

    @cached_property
    def train(self) -> Train | None:
        """Its own, or the only one."""
        trains = find_trains(self.motion.system)
        return find_train(self.motion.system, self.name) or (trains[0] if len(trains) == 1 else None)

    @cached_property
    def angle(self) -> Vector:
        """Of its cam (rad); nan without any."""
        angle = self.train.angle if self.train else self.motion.angle
        return angle.factor * self.motion.column(angle.source) if angle else np.nan * self.motion.times

    @cached_property
    def turned(self) -> Vector:
        """By its cam from the first row on (rad), forwards or backwards."""
        return np.abs(self.angle - self.angle[0])

    @cached_property
    def last_turn(self) -> "Part | None":
        """The rows of the cam's last whole turn; None where there is none."""
        begin = self.turned[-1] - 2.0 * math.pi
        if not begin + SLACK >= 0.0:
            return None
        first = max(0, int(np.searchsorted(self.turned, begin + ROUNDING)) - 1)
        return Part(self.motion.cut(first), self.name)

    @cached_property
    def cam_lift(self) -> Vector | None:
        return self.motion.column(f"{self.train.cam}.cam_lift") if self.train else None

    @cached_property
    def nose(self) -> int | None:
        """The row of its cam's greatest lift, in the last whole turn, else in all rows; of a dwell the middle
        one. None where the rows do not reach it."""
        turn = self.last_turn or self
        if self.train is None or turn.cam_lift is None:
            return None
        largest, known = float(np.max(turn.cam_lift)), self.train.largest_lift
        if largest <= 0.0 or (self.last_turn is None and not 0.0 < known <= largest / NEAR):
            return None
        rows = np.flatnonzero(turn.cam_lift >= largest * (1.0 - ROUNDING))
        dwell = rows[: 1 + np.argmax(np.diff(rows, append=rows[-1] + 2) > 1)]
        return int(dwell[dwell.size // 2]) + self.motion.times.size - turn.motion.times.size

    @cached_property
    def lifted(self) -> NDArray[np.bool_]:
        """Where its cam lifts (`Train.lobe`); everywhere, if it has no cam of its own."""
        if self.train is None or self.cam_lift is None:
            return np.ones(self.motion.times.size, dtype=np.bool_)
        return np.asarray(self.cam_lift > self.train.lobe)

    @cached_property
    def lost(self) -> NDArray[np.bool_]:
        """Where this contact is lost (`ContactLaw`)."""
        return find_lost_rows(self.motion.system, self.name, self.motion.column)

    def parameter(self, name: str) -> float:
        return parameter_of(self.motion.system.instances[self.name], name)

    def integrate(self, values: Vector | NDArray[np.bool_], over: Vector) -> float:
        """Over a variable, in the last whole cycles of the motion, of less in all rows."""
        times, begin = self.motion.times, self.motion.begin

        def cut(rows: Vector | NDArray[np.bool_]) -> Vector:
            first = [np.interp(begin, times, np.asarray(rows, dtype=np.float64))]
            return np.concatenate([first, rows[times > begin]])

        return float(np.trapezoid(cut(values), cut(over)))

    def mean(self, values: Vector | NDArray[np.bool_]) -> float:
        """Over the time, as `integrate` does."""
        times = self.motion.times
        return self.integrate(values, times) / float(times[-1] - self.motion.begin)


# What is asked of a part, and how it is found.
Figure = tuple[Quantity, Callable[[Part], Found]]


def find_largest(variable: str) -> Callable[[Part], Found]:
    return lambda part: Found.largest(part[variable])


def find_least(variable: str) -> Callable[[Part], Found]:
    return lambda part: Found.at(part[variable], np.argmin(part[variable]))
