"""The cam that is designed: bumps on the scenario's ramps, and how its follower touches it."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np

from models.core.quantities import Vector
from models.valve_train.cams.bumps import Bumps
from models.valve_train.cams.lift import Lift
from models.valve_train.cams.ramps import add_ramp
from models.valve_train.cams.table import TURN, Points
from models.valve_train.worn_cam import PLACES, CamKind

from ...errors import MistakeError

# Half a step (rad) for the jerk of ramps and of the scenario's own cam, and rows of a bump's interval.
STEP, FINE = 1e-4, 8


class Curve(NamedTuple):
    """A lift (m) at cam angles with three derivatives (m/rad^n)."""

    s: Vector
    ds: Vector
    dds: Vector
    ddds: Vector


class Touch(NamedTuple):
    """The contact along a curve: see `CamContact`; `turn` of the normal by the cam angle in the cam's frame,
    so that `cam_rate`/`turn` is the cam's radius of curvature; `entraining` is twice the entraining velocity
    per cam angle (m)."""

    cam_rate: Vector
    turn: Vector
    pressure_angle: Vector
    arm: Vector
    entraining: Vector


@dataclass(frozen=True)
class Lobe:
    """The event between cam angles `begin` and `end` (rad) where the ramps join, and so many bumps in it."""

    kind: CamKind
    begin: float
    end: float
    splines: int
    symmetric: bool = False

    @cached_property
    def bumps(self) -> Bumps:
        return Bumps(self.begin, self.end, self.splines, self.symmetric)

    @property
    def count(self) -> int:
        """Of coefficients."""
        return self.bumps.count

    @cached_property
    def angles(self) -> Vector:
        """Cam angles (rad) of the event at which limits are looked at."""
        rows = FINE * (self.splines + 5) + 1
        return np.linspace(self.begin, self.end, rows)

    @cached_property
    def matrices(self) -> tuple[Vector, ...]:
        """Lift and its derivatives at `angles` of a coefficient of 1."""
        return tuple(self.bumps.at(self.angles, nu) for nu in range(4))

    @cached_property
    def ramps(self) -> Curve:
        """Those of the scenario's cam, at `angles`."""
        return self._trace(self.ramp)

    def ramp(self, angle: float) -> Lift:
        """Ramps alone, as a table's profile adds them."""
        half = 0.5 * (self.end - self.begin)
        from_middle = (angle - self.begin - half + math.pi) % TURN - math.pi
        side = 1.0 if from_middle < 0.0 else -1.0
        found = add_ramp(Lift(0.0, 0.0, 0.0), half + side * from_middle, side > 0.0, self.kind.record)
        return Lift(found.s, side * found.ds, found.dds)

    @cached_property
    def start(self) -> Vector:
        """The coefficients nearest to the scenario's own lift."""
        return self.near(0.0)

    def near(self, smoothing: float) -> Vector:
        """Those near to the scenario's own lift, with less jerk: see `Bumps.fit`."""
        own, ramps = self.own, self.ramps
        return self.bumps.fit(self.angles, own.s - ramps.s, own.dds - ramps.dds, smoothing)

    @cached_property
    def own(self) -> Curve:
        """The scenario's cam, at `angles`."""
        return self._trace(self.kind.lift)

    def _trace(self, lift: Callable[[float], Lift]) -> Curve:
        s, ds, dds = np.array([lift(a) for a in self.angles]).T
        later, earlier = (np.array([lift(a + d).dds for a in self.angles]) for d in (STEP, -STEP))
        return Curve(s, ds, dds, (later - earlier) / (2.0 * STEP))

    def curve(self, coefficients: Vector) -> Curve:
        """The designed lift at `angles`."""
        found = (r + m @ coefficients for r, m in zip(self.ramps, self.matrices, strict=True))
        return Curve(*(np.asarray(one) for one in found))

    def points(self, coefficients: Vector) -> Points:
        """The designed lift with its ramps through points at PLACES."""
        ramps, matrices = self._at_places
        lift, slope, curvature = (r + m @ coefficients for r, m in zip(ramps, matrices, strict=True))
        return Points(PLACES, lift, slope, curvature)

    @cached_property
    def _at_places(self) -> tuple[Vector, list[Vector]]:
        """Lift and two derivatives of the ramps and of a coefficient of 1, at PLACES."""
        ramps = np.array([self.ramp(a) for a in PLACES]).T
        return ramps, [self.bumps.at(PLACES, nu) for nu in range(3)]

    def touch(self, curve: Curve, geometry: Any) -> Touch:
        """Where the follower touches the cam of this lift."""
        touch = self.kind.follower.touch
        rows = np.array([touch(Lift(*row), geometry) for row in zip(*curve[:3], strict=True)])
        _, _, n_x, n_y, arm, _, cam_rate, follower_rate, normal_turn = rows.T
        return Touch(cam_rate, normal_turn + 1.0, np.arctan2(n_x, n_y), arm, cam_rate + follower_rate)


def find_event(kind: CamKind, given: tuple[float, float] | None) -> tuple[float, float]:
    """The cam angles (rad) at which the scenario's ramps join its event; `given` ones go first."""
    if given is not None:
        begin, end = given
        if not begin < end < begin + TURN:
            raise MistakeError(
                f"event = from {math.degrees(begin):g} to {math.degrees(end):g} deg: must end after its "
                "begin, within a turn"
            )
        return given
    record = kind.record
    if hasattr(record, "event_begin"):
        return float(record.event_begin), float(record.event_end)
    fall = record.fall_angle or record.rise_angle
    return (
        math.pi - record.dwell_half_width - record.rise_angle,
        math.pi + record.dwell_half_width + fall,
    )
