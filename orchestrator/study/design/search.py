"""The search for the best cam: cycles of the train, an optimum of what they say, and cycles again.

The tangents of the train's cycles make a linear model of its loads, with its vibrations.
The optimum within a box around the last lift is taken where the cycles confirm it; else the box shrinks.
A contact that is lost answers nothing: loads at a speed of separation are then continued from the next lower
speed that keeps contact, by the square of the speed.
"""

import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from models.core.quantities import Vector
from models.core.system import ModelError
from models.monolithic.cycle import Cycle

from ...assessment.figures_of_merit import CONTACT
from ...assessment.motion import Found as Value
from ...assessment.motion import Motion, Part
from ...reporter import show_share
from ..speeds.figure_slopes import differentiate_figures
from ..speeds.separation import is_separated
from ..speeds.subject import to_motion
from .answers import Answer, differ_by_speed, go_on
from .figures import AREA, bound_lines, read_figures
from .files import SCENARIO
from .limits import (
    SMALL_GAP,
    Limit,
    Model,
    film_limits,
    gap_limit,
    load_limit,
    pressure_limit,
)
from .shaping import Shaping
from .slp import Active, Line
from .wanted import CONFIRMED, Found, Improved, describe

# Of the largest lift: the box of the coefficients at first, at most, and where the search ends.
BOX, LARGEST, SMALLEST = 0.05, 0.15, 2e-3
SHORTER, LONGER, MOST_ROUNDS = 0.35, 2.0, 40
# A round that adds less of the objective is the last, in a small box such a number of them on end.
LITTLE, FEW = 5e-4, 3
# A limit with more than this share left does not hold a cam.
NEAR = 0.02
# Where contact is lost, lower speeds are tried in such steps, and then between the last two: to 0.2 %.
LOWER, MOST_LOWER, HALVINGS = 0.97, 8, 4
# Rows of a part of a cycle in which figures of landings are found, besides those of its events.
PART = 720
# A share of speed counts as this share of load.
SEVERE = 2.0
RPM = 30.0 / math.pi
# A limit of loads is met with this share of their scale to spare. Cams within all limits of the model have
# lost contact at a speed 0.8 % lower, which is 1.6 % of load.
SPARE = 0.025


class Seen(NamedTuple):
    """A cycle and its figures, at the speed `near` (rad/s): the next lower one where contact is lost.

    `parting` is the highest speed found that keeps contact.
    """

    near: float
    cycle: Cycle
    figures: Mapping[str, Value]
    parting: float


Best = Callable[[Found, Mapping[float, Seen]], None]


@dataclass(frozen=True)
class Search(Shaping):
    """The search with cycles of the train, and the limits that these must keep."""

    def measured(self, speed: float) -> list[str]:
        """Figures that are limited or wanted at a speed (rad/s)."""
        objective, asked = self.wanted.objective, speed in self.wanted.speeds
        lands = asked or speed in self.wanted.landings
        limited = (one.name for one in self.wanted.figures if asked or (lands and one.lands))
        return sorted({*limited, *[objective.name] * (asked and objective.is_figure)})

    @property
    def whole(self) -> bool:
        """Whether tangents are needed of the whole cycle."""
        others = not all(one.lands for one in self.wanted.figures)
        return bool(others or self.wanted.objective.is_figure or self.train.parameters)

    def kept(self, x: Vector) -> list[float]:
        """Speeds (rad/s) up to which contact is to be kept."""
        factor = math.exp(float(x[-1])) if self.stretched else 1.0
        return [factor * speed for speed in self.wanted.kept]

    @property
    def contacts(self) -> list[str]:
        return self.train.train.contacts

    @property
    def columns(self) -> list[str]:
        film = [f"{self.contacts[0]}.film_ratio"] * bool(self.wanted.film)
        gaps = (f"{name}.least_gap" for name in self.wanted.gaps)
        return [*(f"{name}.load" for name in self.contacts), *film, *gaps]

    def all_speeds(self, x: Vector) -> list[float]:
        return sorted({*self.wanted.idle, *self.wanted.speeds, *self.wanted.landings, *self.kept(x)})

    def is_lost(self, cycle: Cycle) -> bool:
        return is_separated(self.to_motion(cycle), "lost")

    def to_motion(self, cycle: Cycle) -> Motion:
        return to_motion(cycle, self.train.subject.flywheel)

    def improve(self, kept: Vector | None, best: Best) -> Improved:
        """Rounds of cycles and optima from what a search has `kept`, else from the own cam; `best` gets
        each better one, and the cycles of it."""
        origin = "start, the scenario's cam as splines" if kept is None else f"goes on from {SCENARIO}"
        start = self.begin() if kept is None else kept
        show_share(0.0, ", the first cam")
        seen = self.look(start)
        found = self.judge(start, seen)
        self.tell(f"{origin}: {describe(found, self.wanted.objective)}")
        if found.beyond:
            self.tell("it breaks limits itself: the first rounds look for a cam that keeps them all")
        best(found, seen)
        accepted = model = self.model(start, seen)
        box, refused, small = BOX, 0, 0
        own = model.objective.gradient[self.train.lobe.count :]
        for name, slope in zip(self.train.parameters, own, strict=False):
            if slope == 0.0 and self.wanted.objective.is_figure:
                self.tell(f"{model.objective.name} does not change with {name}: only limits hold it")
        for number in range(1, MOST_ROUNDS):
            show_share(number / MOST_ROUNDS, f", round {number} of at most {MOST_ROUNDS - 1}")
            x = self.solve(model, found.unknowns, box, self.starts if number == 1 else 1).unknowns
            # A box within a refused step does not hold the same optimum again.
            shorter = SHORTER * min(box, float(np.max(np.abs(x - found.unknowns) / self.scale)))
            gain, cycles = 0.0, {}
            try:
                cycles = self.look(x)
                here = self.judge(x, cycles)
                said, gain = describe(here, self.wanted.objective), here.rank - found.rank
                if gain > 0.0:
                    accepted = model = self.model(x, cycles)
            except ModelError as error:
                said, gain, cycles = f"no cycles ({error})", 0.0, {}
            if gain > 0.0:
                self.tell(f"round {number}: {said}")
                small = small + 1 if gain <= LITTLE else 0
                # In a smaller box a round adds little where another may add more.
                done = small == FEW or (small > 0 and box >= BOX)
                box, found, refused = min(LARGEST, LONGER * box), here, 0
                best(found, cycles)
            else:
                self.tell(f"round {number} refused: {said}; a smaller step is tried")
                model = self.correct(model, x, cycles) if cycles else model
                box, refused, done = shorter, refused + 1, shorter < SMALLEST
            if done:
                break
        ended = f"the search ended because its steps became too small (refused rounds at last: {refused})"
        trapped = refused > 0 and box < SMALLEST
        return Improved(found, self.find_active(accepted, found.unknowns, box), ended * trapped)

    def find_active(self, model: Model, x: Vector, box: float) -> list[tuple[Active, float]]:
        """What holds a cam, by the model of its own cycles, not as refused rounds corrected it. The optimum
        of the model reaches farther. Where that breaks a limit, multipliers are no prices."""
        last = self.solve(model, x, max(box, SMALLEST), 1)
        angles, lines = self.train.lobe.angles, {line.name: line.angle for line in model.lines}
        spare = {rows.name: -float(rows.excess.max()) for rows in model.evaluate(x).limits}
        return [
            (
                one._replace(spare=spare[one.name], gain=one.gain if last.feasible else 0.0),
                lines.get(one.name, float(angles[one.row])),
            )
            for one in last.active
            if spare[one.name] <= NEAR
        ]

    def look(self, x: Vector) -> dict[float, Seen]:
        """The cycles at all speeds; where contact is lost, those of the next lower speeds that keep it."""
        found: dict[float, Seen] = {}
        kept = self.kept(x)
        for speed in self.all_speeds(x):
            near, cycle = speed, self.train.simulate(x, speed)
            for _ in range(MOST_LOWER * (speed in kept)):
                if not self.is_lost(cycle):
                    break
                near *= LOWER
                cycle = self.train.simulate(x, near)
            names = self.measured(speed)
            figures = read_figures(self.to_motion(cycle), names) if names else {}
            found[speed] = Seen(near, cycle, figures, near)
        lost = {speed: self.find_parting(x, one.near) for speed, one in found.items() if one.near < speed}
        return found | {speed: found[speed]._replace(parting=parting) for speed, parting in lost.items()}

    def find_parting(self, x: Vector, kept: float) -> float:
        """The highest speed found that keeps contact; it is lost a step above `kept`."""
        lost = kept / LOWER
        for _ in range(HALVINGS):
            middle = 0.5 * (kept + lost)
            kept, lost = (kept, middle) if self.is_lost(self.train.simulate(x, middle)) else (middle, lost)
        return kept

    def judge(self, x: Vector, seen: Mapping[float, Seen]) -> Found:
        """What the cycles say of the limits, and the cam of its own."""
        excesses: dict[str, float] = {}
        for speed, (_, cycle, figures, parting) in seen.items():
            at = f"at {speed * RPM:.0f} r/min"
            if parting < speed:
                excesses[f"separation {at}"] = SEVERE * (1.0 - parting / speed)
            motion = self.to_motion(cycle)
            for name in self.contacts:
                part = Part(motion, name)
                if (least := self.wanted.least_load) > 0.0:
                    load = CONTACT["least_load"][1](part).value
                    excesses[f"least load of {name} {at}"] = 1.0 - load / least
                if name in self.wanted.pressures:
                    pressure = CONTACT["peak_pressure"][1](part).value
                    excesses[f"pressure in {name} {at}"] = pressure / self.wanted.pressures[name] - 1.0
            for name, least in self.wanted.gaps.items():
                gap = float(cycle[f"{name}.least_gap"].min())
                excesses[f"coil bind of {name} {at}"] = (least - gap) / max(abs(least), SMALL_GAP)
            if self.wanted.film and speed not in self.wanted.idle:
                ratios = self.train.film_ratios(cycle.__getitem__)
                excesses[f"film ratio {at}"] = 1.0 - float(np.nanmin(ratios)) / self.wanted.film
            for one in (one for one in self.wanted.figures if one.name in figures):
                excesses[f"{one.name} {at}"] = one.side * (figures[one.name].value - one.size) / one.scale
        area, objective = self.area_line(x), self.wanted.objective
        if objective.name == AREA:
            reached = area.value
        else:
            excesses[area.name] = self.wanted.area - area.value
            values = {v: one.figures[objective.name].value for v, one in seen.items()
                      if objective.name in one.figures}  # fmt: skip
            reached = math.exp(float(x[-1])) if self.stretched else objective.weigh(values)
        beyond = {name: excess for name, excess in excesses.items() if excess > CONFIRMED}
        return Found(x, reached, beyond | self.own_excesses(x), area.value)

    def model(self, x: Vector, seen: Mapping[float, Seen]) -> Model:
        """The limits, with the answers and figures around `x`."""
        lobe, limits, lines = self.train.lobe, list(self.own_limits(x)), list[Line]()
        answers: dict[float, Answer] = {}
        slopes: dict[float, Mapping[str, Vector]] = {}
        for speed, (near, cycle, figures, _) in seen.items():
            at = f"at {speed * RPM:.0f} r/min"
            tangents = self.train.differentiate(x, cycle, self.whole, lands=bool(figures))
            answer = self.train.answer(tangents, cycle, near, self.columns)
            # Those of lost contact are continued from lower speeds.
            answers[speed] = go_on(answers, answer, speed)
            limits += self.list_limits(x, answers[speed], answers[min(answers)], at)
            if figures:
                rows, shaft = 0 if self.whole else PART, self.train.subject.flywheel
                found = differentiate_figures(tangents, shaft, samples=rows, names=figures)
                # A valve may land outside the part that has tangents.
                none = np.zeros(x.size)
                slopes[speed] = {n: found[n].slopes if n in found else none for n in figures}
                angles = self.train.angles(cycle)
                lines += bound_lines(self.wanted.figures, figures, slopes[speed], x, at, angles, lobe)
        objective, area = self.wanted.objective, self.area_line(x)
        if objective.name != AREA:
            lines.append(area)
        return Model(
            lobe, limits, answers, x.copy(), self.geometry, self.scale,
            self.objective_line(x, seen, slopes) if objective.name != AREA else area, lines, self.stretched,
        )  # fmt: skip

    def correct(self, model: Model, x: Vector, seen: Mapping[float, Seen]) -> Model:
        """Loads and films of the model, less what those of the cycles at `x` are worse than it foresaw: as
        rebounds of loose parts make them that no tangent knows. Speeds that changed with `x` stay. Figures
        bend on the way to `x`: a valve that does not bounce has no slope of it."""
        answers: dict[float, Answer] = {}
        there: dict[str, float] = {}
        for speed, (near, cycle, figures, _) in sorted(seen.items()):
            found = Answer(near, self.train.read(cycle.__getitem__, self.columns), {}, cycle)
            answers[speed] = go_on(answers, found, speed)
            there |= {f"{name} at {speed * RPM:.0f} r/min": one.value for name, one in figures.items()}
        step, kept = x - model.place, model.answers
        worse = {v: one.worsen(answers[v], step) if v in answers else one for v, one in kept.items()}
        lines = [
            one.bend(x, there[one.name], self.scale) if one.name in there else one for one in model.lines
        ]
        return replace(model, answers=worse, lines=lines)

    def objective_line(
        self, x: Vector, seen: Mapping[float, Seen], slopes: Mapping[float, Mapping[str, Vector]]
    ) -> Line:
        """Of the speed of separation, or a figure."""
        objective = self.wanted.objective
        if self.stretched:
            return Line(objective.name, 1.0 + float(x[-1]), np.eye(x.size)[-1], x)
        speeds = [v for v in slopes if objective.name in slopes[v]]
        values = {v: seen[v].figures[objective.name].value for v in speeds}
        shares = [slopes[v][objective.name] / abs(objective.before[v]) for v in speeds]
        gradient = objective.sign * np.mean(shares, axis=0)
        return Line(objective.name, objective.weigh(values), gradient, x)

    def list_limits(self, x: Vector, answer: Answer, slowest: Answer, at: str) -> Iterator[Limit]:
        """Of loads, pressures, film and gaps at the speed of an answer."""
        lobe, geometry, wanted = self.train.lobe, self.geometry(x), self.wanted
        curve, speed = lobe.curve(x[: lobe.count]), answer.speed
        touch, lifted = lobe.touch(curve, geometry), self.train.lifted(curve.s)
        arc = 1.0 / geometry.radius if hasattr(geometry, "radius") else 0.0
        first, kept = next(iter(self.contacts), ""), speed in self.kept(x)
        for name in self.contacts:
            column = f"{name}.load"
            load = answer.columns[column]
            scale, least = float(np.max(load.high)), wanted.least_load
            if kept or least > 0.0:
                change = differ_by_speed(slowest, answer, column) if kept and speed > slowest.speed else None
                word = f"{'separation' if kept else 'least load'} of {name} {at}"
                yield load_limit(word, column, speed, least + SPARE * scale, scale, lifted, change)
            if name in wanted.pressures:
                bend = touch.turn / touch.cam_rate + arc if name == first else np.ones(curve.s.size)
                own = self.train.read(answer.cycle.__getitem__, [column, f"{name}.maximum_pressure"])
                force, pressure = (one.high for one in own.values())
                strong = np.where(force > 0.2 * force.max(), force * bend, 0.0)
                row = int(np.argmax(strong))
                stiffness = float(pressure[row] ** 2 / strong[row])
                word, most = f"pressure in {name} {at}", wanted.pressures[name]
                yield pressure_limit(word, column, speed, most, stiffness, arc if name == first else None)
        if wanted.film and speed not in wanted.idle:
            ratios = self.train.film_ratios(answer.cycle.__getitem__)
            yield from film_limits(at, f"{first}.film_ratio", speed, wanted.film, ratios, touch.entraining)
        for name, gap in wanted.gaps.items():
            yield gap_limit(f"coil bind of {name} {at}", f"{name}.least_gap", speed, gap)
