"""The steady cycles of a train with a designed cam, and how its contacts answer to a change of the lift."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np

from models.contact.films import FILMS
from models.core.quantities import Vector
from models.monolithic.cycle import STEADY, Cycle
from models.monolithic.cycle_tangents import CycleTangents, Direction, differentiate_cycle, differentiate_part
from models.valve_train.cams.table import TURN
from models.valve_train.worn_cam import sample_cam

from ...assessment.lost_contact import has_film
from ...assessment.trains import Train, check_lash, find_trains
from ...errors import MistakeError, Option, one_of
from ...scenario import Scenario, build_scenario
from ...scenario.cams import read_cam
from ...scenario.files import put_parameters
from ...scenario.system import build_system, list_parameters
from ..speeds.finder import CycleFinder
from ..speeds.subject import SpeedSubject, count_turns, find_flywheel
from ..wear.train import put_points
from .answers import Answer, Column, find_dips, follow_reversal
from .brief import Ramps
from .lobe import Lobe, find_event
from .wires import WireLength, list_wires, wind

# Of the largest lift and of a parameter, the changes along which settings are differentiated.
SHARE = 1e-5
# Tangents may be off by 1e-5 in a step, over those of exact ones.
COARSE = 1e3
# Of the cam (rad), behind the event: the ramp on which a valve lands, and 60 deg in which it may bounce.
LANDING = math.pi / 2.0
DRY = list(FILMS).index("dry")
# Of the distance of angles, where the rows around one begin: half, but not where a row could stand.
BEFORE = 0.4953


@dataclass(frozen=True)
class DesignedTrain:
    """A scenario with its cam through points. `parameters` are unknowns besides the lift, by
    "component.name", each with the width of its range."""

    scenario: Scenario
    subject: SpeedSubject
    cam: str
    lobe: Lobe
    parameters: Mapping[str, float] = field(default_factory=dict)
    wires: Mapping[str, WireLength] = field(default_factory=dict)

    @cached_property
    def finder(self) -> CycleFinder:
        return CycleFinder(self.subject)

    @property
    def train(self) -> Train:
        system = self.finder.system
        return next(train for train in find_trains(system) if train.cam == self.cam)

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
        return {name: known[name] if name in known else self.wires[name].size for name in self.parameters}

    @property
    def steps(self) -> Vector:
        """Of differences by the unknowns."""
        given = zip(self.given.values(), self.parameters.values(), strict=True)
        sizes = [abs(own) or width for own, width in given]
        return SHARE * np.array([float(self.lobe.own.s.max())] * self.lobe.count + sizes)

    def values(self, unknowns: Vector) -> dict[str, float]:
        """Of the parameters among the unknowns."""
        return dict(zip(self.parameters, map(float, unknowns[self.lobe.count :]), strict=False))

    def settings(self, unknowns: Vector) -> dict[str, float]:
        """All parameters of the system that the unknowns give."""
        points = self.lobe.points(unknowns[: self.lobe.count]).parameters()
        values = {f"{self.cam}.{name}": value for name, value in points.items()}
        return values | wind(self.wires, self.values(unknowns))

    def simulate(self, unknowns: Vector, speed: float) -> Cycle:
        """The steady cycle at a speed (rad/s)."""
        return self.finder.begin(self.settings(unknowns), speed)

    def read(self, column: Callable[[str], Vector], names: Sequence[str]) -> dict[str, Column]:
        """Outputs over the event's angles, in the last turn of the cam."""
        angle = column(f"{self.cam}.{self.train.role.angle}")
        turned = angle - angle[-1] + TURN
        last = turned >= 0.0
        at = (angle[last] - self.lobe.begin) % TURN
        edges = np.append(self.lobe.angles, self.lobe.angles[-1] + np.diff(self.lobe.angles[-2:]))
        cell = np.searchsorted(edges - self.lobe.begin - BEFORE * np.diff(edges[:2]), at, side="right") - 1
        inside = (cell >= 0) & (cell < self.lobe.angles.size)
        rows, cells, every = np.flatnonzero(last)[inside], cell[inside], np.arange(self.lobe.angles.size)
        found = {}
        for name in names:
            values = column(name)[rows]
            order = np.lexsort((values, cells))
            seen, first = np.unique(cells[order], return_index=True)
            end = np.append(first[1:], order.size) - 1
            sides = values[order[first]], values[order[end]], rows[order[first]]
            found[name] = Column(*(np.interp(every, seen, side) for side in sides))
        return found

    def angles(self, cycle: Cycle) -> Callable[[int | None], float]:
        """The cam angle (rad) in its turn at a row; nan of none."""
        angle = cycle[f"{self.cam}.{self.train.role.angle}"] % TURN
        return lambda row: math.nan if row is None else float(angle[row])

    @property
    def has_film(self) -> bool:
        """Whether the film of the cam's contact has a meaning."""
        contact = self.finder.system.instances[self.train.contacts[0]]
        layout = contact.component.parameters
        p = layout.view(layout.vector(contact.parameters))
        return bool(p.roughness != 0.0 and getattr(p, "film_model", math.nan) != DRY)

    def film_ratios(self, column: Callable[[str], Vector]) -> Vector:
        """The least film over roughness of the cam's contact, at the event's angles; nan under light load."""
        name = self.train.contacts[0]
        found = self.read(column, [f"{name}.film_ratio", f"{name}.load"])
        under = has_film("film_ratio", found[f"{name}.load"].low)
        return np.where(under, found[f"{name}.film_ratio"].low, np.nan)

    def differentiate(
        self, unknowns: Vector, cycle: Cycle, whole: bool, lands: bool = False
    ) -> CycleTangents:
        """The tangents of a cycle by the unknowns: of the `whole` one, or of the event alone, whose start
        coefficients of the lift do not change: bounces on the base circle before it may be endless. Where a
        valve `lands`, its ramp and its bounces belong to the event."""
        here, directions = self.settings(unknowns), []
        steps = np.append(self.steps, np.ones(unknowns.size - self.steps.size))
        for which, step in enumerate(steps):
            changed = unknowns.copy()
            changed[which] += step
            there = self.settings(changed).items()
            directions.append(Direction({n: (v - here[n]) / step for n, v in there if v != here[n]}))
        period = float(cycle.times[-1])
        if whole:
            turning = [f"{self.subject.flywheel}.angle"]
            return differentiate_cycle(cycle.system, period, turning, directions, cycle.end, STEADY, COARSE)
        angle, margin = cycle[f"{self.cam}.{self.train.role.angle}"], np.ptp(self.lobe.angles[:2])
        first = int(np.argmin((angle - self.lobe.begin + margin) % TURN))
        turned = min(TURN, np.ptp(self.lobe.angles) + 3.0 * margin + lands * LANDING)
        duration = period * float(turned / np.ptp(angle))
        begin, start = float(cycle.times[first]), cycle.states[first]
        return differentiate_part(cycle.system, begin, duration, directions, start, COARSE)

    def answer(self, tangents: CycleTangents, cycle: Cycle, speed: float, names: Sequence[str]) -> Answer:
        """The outputs of a cycle at the event's angles, with their derivatives."""
        columns = self.read(cycle.__getitem__, names)
        begin, period = tangents.begin, cycle.times[-1]
        times = {name: begin + (one.row * cycle.times[1] - begin) % period for name, one in columns.items()}
        every = np.unique(list(times.values()))
        rows, gradients, layout = tangents.rows_at(every), {}, tangents.system
        for name, own in times.items():
            places = np.searchsorted(every, own)
            gradients[name] = rows.outputs_by[:, places, layout.outputs.names.index(name)].T
            contact, _, output = name.rpartition(".")
            if output == "film_ratio":
                velocity = f"{contact}.entraining_velocity"
                moved = rows.inputs_by[:, places, layout.inputs.names.index(velocity)].T
                cell = math.ceil(cycle.times.size * float(np.diff(self.lobe.angles[:2])[0]) / TURN)
                slide = follow_reversal(cycle[name], cycle[velocity], 2 * cell)[columns[name].row.astype(int)]
                gradients[name] = gradients[name] - (slide * find_dips(columns[name].low))[:, None] * moved
        return Answer(speed, columns, gradients, cycle)

    def lifted(self, curve_s: Vector) -> Vector:
        """Where the cam lifts, as the figures of merit count it."""
        return np.asarray(curve_s > self.train.find_lobe(float(curve_s.max())))


def open_train(
    tables: Mapping[str, Any],
    count: int,
    component: str | None = None,
    event: tuple[float, float] | None = None,
    ramps: Ramps | None = None,
    symmetric: bool = False,
) -> DesignedTrain:
    """The train of a scenario; MistakeError or ModelError for one without a cam on a flywheel."""
    own, scenario = tables, build_scenario(tables)
    flywheel = find_flywheel(scenario)
    check_lash(system := build_system(scenario))
    cams = [train.cam for train in find_trains(system)]
    if component is None and len(cams) > 1:
        raise MistakeError(f"{scenario.name}: has the cams {', '.join(cams)}", "choose one with cam = ...")
    cam = component or cams[0]
    if cam not in cams:
        raise MistakeError((Option("cam", cam), f": {one_of(cams, cam)}"))
    if ramps is not None:
        own = _put_ramps(own, cam, ramps, list_parameters(scenario))
        scenario = build_scenario(own)
    kind = read_cam(scenario.components[cam])
    begin, end = find_event(kind, event)
    lobe = Lobe(kind, begin, end, count, symmetric)
    subject = SpeedSubject(put_points(own, cam, sample_cam(kind)), flywheel)
    return DesignedTrain(scenario, subject, cam, lobe, wires=dict(list_wires(own)))


def _put_ramps(
    tables: Mapping[str, Any], cam: str, ramps: Ramps, known: Mapping[str, float]
) -> dict[str, Any]:
    """With ramps of this height and velocity: v = height/(constant + blend), as `add_ramp` has it."""
    if f"{cam}.ramp_blend_angle" not in known:
        raise MistakeError(f"ramps: {cam} has none of its own; its lift table holds them")
    blend = known[f"{cam}.ramp_blend_angle"]
    constant = ramps.height / ramps.velocity - blend
    if not 0.0 <= constant <= math.pi:
        given, most = (1e3 * math.radians(v) for v in (ramps.velocity, ramps.height / blend))
        raise MistakeError(
            f"ramps.velocity = {given:.4g} mm/deg: must be at most {most:.4g} mm/deg for a height of "
            f"{1e3 * ramps.height:.4g} mm, by ramp_blend_angle of {cam}, and reach it in half a turn"
        )
    values = {"ramp_height": ramps.height, "opening_ramp_angle": constant, "closing_ramp_angle": constant}
    return put_parameters(tables, {f"{cam}.{name}": value for name, value in values.items()})
