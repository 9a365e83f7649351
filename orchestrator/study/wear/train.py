"""A valve train whose cam wears: its steady cycle, and what that wears off over the wear coefficient."""

import copy
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
from scipy.ndimage import gaussian_filter1d

from models.contact.wear import trapezoidal, worn_depth
from models.core.quantities import Vector
from models.core.system import System
from models.monolithic.cycle import Cycle, find_cycle
from models.valve_train.worn_cam import EDGES, PLACES, FreshCam, choose_filter, sample_cam, smooth

from ...assessment.figures_of_merit import CONTACT
from ...assessment.friction.cycle import TURN, last_revolution
from ...assessment.friction.cycle import Cycle as Revolution
from ...assessment.friction.judge import find_sliding, list_columns
from ...assessment.motion import Part
from ...assessment.trains import find_train, parameter_of
from ...errors import MistakeError, Option, one_of
from ...scenario import Scenario, build_scenario
from ...scenario.cams import read_cam
from ...scenario.lift_table import replace_law
from ...scenario.system import build_system
from ..speeds.subject import SAMPLES, SpeedSubject, find_flywheel, find_own_speed, find_period, to_motion

# Rows of a state: depth of the cam along its normal and its loss of lift, at PLACES; depth along the
# follower, if it wears too.
CAM, LOSS, FOLLOWER = range(3)
# Places along the follower reach so far beyond the contact's path, as a part of it, for the contact's width,
# and by the filter's tail, in standard deviations: its kernel has four.
MARGIN, TAIL = 0.1, 4.0
FIGURES = ("peak_pressure", "largest_load", "least_film", "lost")


@dataclass(frozen=True)
class Rubbed:
    """What a cycle wears off over the wear coefficient.

    `rate` are the rows of a state, `follower` the depth along it (all N/m). `work` is the load times the
    sliding distance (N m), `distance` the latter (m). `numbers` are those of FIGURES and the largest change
    over the cycle; `end` is its last state.
    """

    rate: Vector
    follower: Vector
    work: float
    distance: float
    numbers: Mapping[str, float]
    end: Vector


@dataclass(frozen=True)
class WearingTrain:
    """The contact that wears, its cam, and the system with a table of the cam's lift.

    `period` is that of its cycle (s), `limit` the depth (m) to which the cam wears,
    or the follower.
    """

    scenario: Scenario
    system: System
    flywheel: str
    contact: str
    cam: str
    fresh: FreshCam
    period: float
    limit: float
    follower_wears: bool

    @property
    def others(self) -> list[str]:
        """The other contacts of its valve train."""
        found = find_train(self.system, self.contact)
        return [name for name in found.contacts if name != self.contact] if found else []

    @property
    def worn(self) -> str:
        """What wears, in words: the component that holds the cam may be the follower that it moves."""
        bodies = "cam and follower" if self.follower_wears else "the cam"
        return f"wear of {bodies} in {self.contact}"

    @property
    def load(self) -> str:
        """The load that wears: that of the asperities, of smooth surfaces all of it."""
        return "asperity_load" if self.parameter("roughness") > 0.0 else "load"

    def parameter(self, name: str) -> float:
        """Of the contact."""
        return parameter_of(self.system.instances[self.contact], name)

    @cached_property
    def unworn(self) -> Cycle:
        return self.simulate(np.zeros(PLACES.size))

    @cached_property
    def along(self) -> Vector:
        """Edges of the places along the follower (m)."""
        offset = self.unworn[f"{self.cam}.contact_offset"]
        beyond = MARGIN * float(np.ptp(offset)) + float(self.unworn[f"{self.contact}.half_width"].max())
        beyond += TAIL * self.filter_along
        return np.linspace(offset.min() - beyond, offset.max() + beyond, PLACES.size + 1)

    def simulate(self, loss: Vector, start: Vector | None = None) -> Cycle:
        """The steady cycle with these losses of lift (m) at PLACES; ModelError where there is none."""
        instances = dict(self.system.instances)
        own = instances[self.cam]
        points = self.fresh.wear_off(loss).parameters()
        instances[self.cam] = replace(own, parameters={**own.parameters, **points})
        worn = self.system.with_instances(instances)
        return find_cycle(worn, self.period, [f"{self.flywheel}.angle"], start, SAMPLES)

    def revolve(self, cycle: Cycle) -> Revolution:
        """The last turn of the cam in a cycle."""
        columns = list_columns(self.system, self.contact, self.cam)
        values = {name: cycle[place] for name, place in columns.items() if place in known(cycle)}
        values.setdefault("cam_speed", np.gradient(values["cam_angle"], cycle.times))
        return last_revolution(self.contact, cycle.times, values)

    @cached_property
    def filter(self) -> float:
        """Standard deviation (rad) by which wear is smoothed."""
        return choose_filter(self.limit, self.fresh.arc)

    @property
    def filter_along(self) -> float:
        """The same along the follower (m): by the arc of the cam, on its mean."""
        return self.filter * float(self.fresh.arc.mean()) if self.follower_wears else 0.0

    @property
    def rows(self) -> tuple[int, ...]:
        return (CAM, LOSS, FOLLOWER) if self.follower_wears else (CAM, LOSS)

    def lose(self, state: Vector) -> Vector:
        """The loss of lift (m) at PLACES by both bodies; the follower touches where it does unworn."""
        if not self.follower_wears:
            return np.asarray(state[LOSS])
        turn, middle = self.revolve(self.unworn), 0.5 * (self.along[1:] + self.along[:-1])
        place = np.interp(PLACES, turn["cam_angle"] % TURN, turn["contact_offset"], period=TURN)
        follower = np.interp(place, middle, state[FOLLOWER]) / self.fresh.overlap_by_lift
        return np.asarray(state[LOSS] + smooth(follower, self.filter))

    @cached_property
    def turn(self) -> float:
        """Time of a turn of the cam (s)."""
        return float(np.ptp(self.revolve(self.unworn).time))

    def rub(self, cycle: Cycle, filter: float = 0.0) -> Rubbed:
        """Archard's law for the last turn of the cam in a cycle; with a `filter` (rad) for the own."""
        turn = self.revolve(cycle)
        distance = np.abs(turn["sliding_velocity"]) * trapezoidal(turn.time)
        work = turn[self.load] * distance
        dose, angle, half = work / self.parameter("length"), turn["cam_angle"] % TURN, turn["half_width"]
        worn = worn_depth(EDGES, angle, half / turn.arc, dose, TURN)
        width, arc = filter or self.filter, np.interp(PLACES, angle, turn.arc, period=TURN)
        cam = smooth(worn, width) / smooth(arc, width)
        follower = worn_depth(self.along, turn["contact_offset"], half, dose)
        part = Part(to_motion(cycle, self.flywheel), self.contact)
        numbers = {name: CONTACT[name][1](part).value for name in FIGURES} | {"change": cycle.change}
        rows = [cam, cam / self.fresh.overlap_by_lift]
        if self.follower_wears:
            rows.append(gaussian_filter1d(follower, self.filter_along / float(np.diff(self.along)[0])))
        return Rubbed(np.array(rows), follower, float(work.sum()), float(distance.sum()), numbers, cycle.end)


def known(cycle: Cycle) -> set[str]:
    """Names of all that a cycle has."""
    return {*cycle.system.outputs.names, *cycle.system.inputs.names}


def open_train(
    tables: Mapping[str, Any],
    contact: str | None,
    speed: float | None,
    limit: float,
    follower_wears: bool = False,
) -> WearingTrain:
    """The train of a scenario, at its own speed or another one of the flywheel (rad/s).

    MistakeError or ModelError for a scenario without a contact that slides on a cam.
    """
    scenario = build_scenario(tables)
    cams = find_sliding(build_system(scenario))
    if not cams:
        raise MistakeError(
            f"{scenario.name}: no contact slides on a cam; give a scenario with a cam's contact"
        )
    if contact is None and len(cams) > 1:
        raise MistakeError(
            f"{scenario.name}: the contacts {', '.join(cams)} slide on cams", ("choose ", Option("contact"))
        )
    name = contact or next(iter(cams))
    if name not in cams:
        raise MistakeError((Option("contact", name), f": {one_of(cams, name)} (those that slide on a cam)"))
    flywheel = find_flywheel(scenario)
    fresh = sample_cam(read_cam(scenario.components[cams[name]]))
    subject = SpeedSubject(put_points(tables, cams[name], fresh), flywheel)
    turned = speed or find_own_speed(scenario, flywheel)
    system = subject.system_at(turned)
    period = find_period(system, turned)
    return WearingTrain(scenario, system, flywheel, name, cams[name], fresh, period, limit, follower_wears)


def put_points(tables: Mapping[str, Any], cam: str, fresh: FreshCam) -> dict[str, Any]:
    """The tables with points in place of the cam's law, table or segments, and of its ramps. The base circle
    is written too: that of a law has another default."""
    changed = copy.deepcopy(dict(tables))
    table = changed["components"][cam]
    replace_law(table, "points")
    table["structure"] = {**table.get("structure", {}), "table_points": fresh.points.angle.size}
    own = {"base_radius": fresh.base_radius, "ramp_height": 0.0}
    table["parameters"] = {**table.get("parameters", {}), **fresh.points.parameters(), **own}
    return changed
