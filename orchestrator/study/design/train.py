"""The steady cycles of a train with a designed cam, and how its contacts answer to a bump of the lift."""

import copy
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np

from models.core import roles
from models.core.quantities import Vector
from models.monolithic.cycle import Cycle
from models.valve_train.cams.table import TURN
from models.valve_train.worn_cam import sample_cam

from ...assessment.motion import LIFTED
from ...assessment.trains import Train, find_trains
from ...errors import MistakeError, Option, one_of
from ...scenario import Scenario, build_scenario
from ...scenario.cams import read_cam
from ...scenario.system import build_system, list_parameters
from ..speeds.finder import CycleFinder
from ..speeds.subject import SpeedSubject, count_turns, find_flywheel
from ..wear.train import put_points
from .lobe import Lobe, find_event

# Of the largest lift, a bump whose answer is measured; of a parameter, its change.
BUMP, SHARE = 2e-3, 1e-3
# Where in the event bumps are measured, as a share of their count; answers between are interpolated.
MEASURED = (0.2, 0.65)


class Column(NamedTuple):
    """An output over the event's angles: its least and largest value around each of them."""

    low: Vector
    high: Vector


class Answer(NamedTuple):
    """Outputs of a cycle at a speed (rad/s), by name, and their derivatives by all unknowns (rows, n)."""

    speed: float
    columns: Mapping[str, Column]
    gradients: Mapping[str, Vector]
    cycle: Cycle


@dataclass(frozen=True)
class DesignedTrain:
    """A scenario with its cam through points. `parameters` are unknowns besides the lift, by
    "component.name", each with the width of its range."""

    scenario: Scenario
    subject: SpeedSubject
    cam: str
    lobe: Lobe
    parameters: Mapping[str, float] = field(default_factory=dict)
    _ends: dict[float, Vector] = field(default_factory=dict)

    @cached_property
    def finder(self) -> CycleFinder:
        return CycleFinder(self.subject)

    @property
    def train(self) -> Train:
        system = self.finder.system
        return next(train for train in find_trains(system) if train.cam == self.cam)

    @property
    def springs(self) -> list[str]:
        """Those whose coils have gaps."""
        return [*self.train.list_parts(roles.CoilSpring), *self.train.list_parts(roles.LoadedSpring)]

    @property
    def own_speed(self) -> float:
        """Of the flywheel (rad/s) in the scenario."""
        return list_parameters(self.scenario)[f"{self.subject.flywheel}.initial_speed"]

    @property
    def ratio(self) -> float:
        """Speed of the cam over that of the flywheel."""
        return 1.0 / count_turns(self.finder.system)

    def with_parameters(self, bounds: Mapping[str, tuple[float, float]]) -> "DesignedTrain":
        """The train with these parameters as unknowns."""
        return replace(self, parameters={name: high - low for name, (low, high) in bounds.items()})

    @property
    def given(self) -> dict[str, float]:
        """The values that the scenario gives the parameters."""
        known = list_parameters(self.scenario)
        return {name: known[name] for name in self.parameters}

    def simulate(self, unknowns: Vector, speed: float) -> Cycle:
        """The steady cycle at a speed (rad/s)."""
        count = self.lobe.count
        points = self.lobe.points(unknowns[:count]).parameters()
        values = {f"{self.cam}.{name}": value for name, value in points.items()}
        values |= dict(zip(self.parameters, map(float, unknowns[count:]), strict=True))
        return self.finder.find(values, speed, self._ends.get(speed))

    def begin_with(self, cycle: Cycle, speed: float) -> None:
        """Further cycles at this speed begin with the last state of this one."""
        self._ends[speed] = cycle.end

    def read(self, cycle: Cycle, names: Sequence[str]) -> dict[str, Column]:
        """Outputs over the event's angles, in the last turn of the cam."""
        angle = cycle[f"{self.cam}.{self.train.role.angle}"]
        turned = angle - angle[-1] + TURN
        last = turned >= 0.0
        at = (angle[last] - self.lobe.begin) % TURN
        edges = np.append(self.lobe.angles, self.lobe.angles[-1] + np.diff(self.lobe.angles[-2:]))
        cell = np.searchsorted(edges - self.lobe.begin - 0.5 * np.diff(edges[:2]), at, side="right") - 1
        inside = (cell >= 0) & (cell < self.lobe.angles.size)
        found = {}
        for name in names:
            values, cells = cycle[name][last][inside], cell[inside]
            low, high = np.full(self.lobe.angles.size, np.inf), np.full(self.lobe.angles.size, -np.inf)
            np.minimum.at(low, cells, values)
            np.maximum.at(high, cells, values)
            missing = ~np.isfinite(low)
            for side in (low, high):
                side[missing] = np.interp(
                    self.lobe.angles[missing], self.lobe.angles[~missing], side[~missing]
                )
            found[name] = Column(low, high)
        return found

    def answer(self, unknowns: Vector, cycle: Cycle, speed: float, names: Sequence[str]) -> Answer:
        """The outputs of a cycle, with their derivatives by differences of cycles."""
        base, count = self.read(cycle, names), self.lobe.count
        largest = float(self.lobe.curve(unknowns[:count]).s.max())
        places = [round(share * (count - 1)) for share in MEASURED]

        def differ(which: int, step: float) -> dict[str, Vector]:
            changed = unknowns.copy()
            changed[which] += step
            there = self.read(self.simulate(changed, speed), names)
            return {
                name: 0.5 * (there[name].low + there[name].high - base[name].low - base[name].high) / step
                for name in names
            }

        bumps = {place: differ(place, BUMP * largest) for place in places}
        others = [
            differ(count + i, SHARE * (abs(float(unknowns[count + i])) or width))
            for i, width in enumerate(self.parameters.values())
        ]
        gradients = {}
        for name in names:
            columns = self._spread({place: found[name] for place, found in bumps.items()})
            gradients[name] = np.column_stack([columns, *(found[name] for found in others)])
        return Answer(speed, base, gradients, cycle)

    def _spread(self, answers: Mapping[int, Vector]) -> Vector:
        """The answers to all coefficients (columns): those of the measured ones, moved and interpolated."""
        angles, bumps = self.lobe.angles, self.lobe.bumps
        measured = {bumps.equal_place(which): answer for which, answer in answers.items()}
        first, last = min(measured), max(measured)
        equal = []
        for place in range(bumps.from_equal.shape[0]):
            weight = min(1.0, max(0.0, (place - first) / (last - first)))
            moved = (
                np.interp(angles - bumps.spacing * (place - at), angles, measured[at], 0.0, 0.0)
                for at in (first, last)
            )
            equal.append(np.array([1.0 - weight, weight]) @ list(moved))
        return np.asarray(np.transpose(equal) @ bumps.from_equal)

    def lifted(self, curve_s: Vector) -> Vector:
        """Where the cam lifts, as the figures of merit count it."""
        return np.asarray(curve_s > LIFTED * curve_s.max())


def open_train(
    tables: Mapping[str, Any],
    count: int,
    component: str | None = None,
    event: tuple[float, float] | None = None,
) -> DesignedTrain:
    """The train of a scenario; MistakeError or ModelError for one without a cam on a flywheel."""
    scenario = build_scenario(copy.deepcopy(dict(tables)))
    flywheel = find_flywheel(scenario)
    cams = [train.cam for train in find_trains(build_system(scenario))]
    if component is None and len(cams) > 1:
        raise MistakeError(f"{scenario.name}: has the cams {', '.join(cams)}", "choose one with cam = ...")
    cam = component or cams[0]
    if cam not in cams:
        raise MistakeError((Option("cam", cam), f": {one_of(cams, cam)}"))
    kind = read_cam(scenario.components[cam])
    begin, end = find_event(kind, event)
    lobe = Lobe(kind, begin, end, count)
    subject = SpeedSubject(put_points(tables, cam, sample_cam(kind)), flywheel)
    return DesignedTrain(scenario, subject, cam, lobe)
