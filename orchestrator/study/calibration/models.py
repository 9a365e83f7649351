"""What a scenario gives for measured positions: a steady cycle at each speed, or its run from the start."""

import json
import math
from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import Any, Literal

import numpy as np
import scipy
from rich.console import Console

from models.core.evaluation import Evaluation
from models.core.quantities import Vector
from models.core.system import ModelError, System
from models.monolithic.cvode import Cvode
from models.monolithic.cycle import USABLE, Cycle
from models.monolithic.cycle_tangents import Direction, differentiate_cycle
from models.monolithic.march import march
from models.monolithic.problem import SystemProblem
from models.monolithic.reference import observe, stiffness

from ...assessment.trains import find_angles
from ...engine.observer import Observer
from ...engine.step import Step
from ...errors import MistakeError, RunError, Set
from ...reporter import Reporter
from ...run.plan import make_plan, open_participants
from ...run.simulation import simulate
from ...scenario import Scenario, build_scenario
from ...scenario.display import Shown, show
from ...scenario.files import put_parameters, to_full_toml
from ...scenario.system import Builder, build_system, list_outputs, resolve, resolve_start
from ...texts import parse_toml
from ..scenario_subject import list_fmu_sums
from ..speeds.finder import CycleFinder
from ..speeds.subject import SpeedSubject, check_varied, count_turns, find_flywheel, find_period
from ..task import format_message
from .measured import TIME, Experiment, Measured

# Of a cycle: of the solver, and of the change of a state, which is far below the noise of a sensor.
CYCLE_TOLERANCE, STEADY = 1e-10, 1e-5
# Errors of steps of tangents, over those that analyses take.
COARSE = 300.0
# Of a transient: near the solver's sharpest, since parameters are varied by 1e-3.
TRANSIENT_TOLERANCE = 1e-10
# Samples of a cycle where the data's positions have no common grid, and a grid's fit.
SAMPLES, ON_GRID = 7200, 1e-6
# Positions at which outputs are kept that were not measured.
FEW = 60


# What a model is asked for: its method.
Task = Literal["predict", "differentiate"]


@dataclass(frozen=True)
class Prediction:
    """Signals (signals, positions), all outputs at some positions, and the state to go on from; of a failure
    its message alone."""

    signals: Vector
    others: Vector
    state: Vector
    message: str = ""


def failed(message: str) -> Prediction:
    none = np.zeros((0, 0))
    return Prediction(none, none, np.zeros(0), message)


def combine(rule: Callable[..., Any], *predictions: Prediction) -> Prediction:
    """Each of its parts by a rule from those of others."""
    names = "signals", "others", "state"
    return Prediction(*(rule(*(getattr(one, name) for one in predictions)) for name in names))


@dataclass(frozen=True)
class Model(ABC):
    """A scenario with all values as a TOML text, and the outputs that were measured: workers get it."""

    toml: str
    variables: tuple[str, ...]

    @cached_property
    def scenario(self) -> Scenario:
        return build_scenario(parse_toml(self.toml))

    @property
    def outputs(self) -> Sequence[str]:
        """The rows of `Prediction.others`."""
        return list(self.shown)

    @cached_property
    def shown(self) -> dict[str, Shown]:
        """How all outputs are shown."""
        return {name: show(quantity) for name, quantity in list_outputs(self.scenario).items()}

    def content(self) -> str:
        """Text that determines the predictions together with values and positions."""
        return json.dumps([type(self).__name__, self.variables]) + self.toml

    @abstractmethod
    def predict(
        self, values: Mapping[str, float], experiment: Experiment, start: Vector | None
    ) -> Prediction:
        """With these parameters "component.parameter"; `start` is the state of a neighbour, None for what the
        parameters alone say."""

    def differentiate(
        self, values: Mapping[str, float], experiment: Experiment, start: Vector | None
    ) -> Prediction:
        """The derivatives of the prediction, with one more axis: that of the `values`. ModelError where only
        differences give them."""
        raise ModelError("only steady cycles have tangents")

    def select(self, rows: Vector, names: Sequence[str], state: Vector) -> Prediction:
        """Of outputs `rows` (positions, outputs, ...) called `names`."""
        place = {name: i for i, name in enumerate(names)}
        signals = rows[:, [place[name] for name in self.variables]].swapaxes(0, 1)
        few = np.unique(np.linspace(0, len(rows) - 1, FEW).round().astype(int))
        others = rows[few][:, [place[name] for name in self.outputs]].swapaxes(0, 1)
        return Prediction(np.ascontiguousarray(signals), np.ascontiguousarray(others), state)


@dataclass(frozen=True)
class CycleModel(Model):
    """The steady cycle at the speed of an experiment."""

    flywheel: str

    def predict(
        self, values: Mapping[str, float], experiment: Experiment, start: Vector | None
    ) -> Prediction:
        shares, cycle = self._find_cycle(values, experiment, start)
        samples = cycle.times.size - 1
        at = shares * samples
        if np.max(np.abs(at - np.round(at))) <= ON_GRID * samples:
            rows = cycle.outputs[np.round(at).astype(int)]
        else:
            rows = scipy.interpolate.CubicSpline(np.linspace(0.0, 1.0, samples + 1), cycle.outputs)(shares)
        return self.select(rows, cycle.system.outputs.names, cycle.end)

    def differentiate(
        self, values: Mapping[str, float], experiment: Experiment, start: Vector | None
    ) -> Prediction:
        shares, cycle = self._find_cycle(values, experiment, start)
        period, turning = float(cycle.times[-1]), [f"{self.flywheel}.angle"]
        # Of each as a whole, as errors of tangents are bounded by their sizes.
        sizes = np.array([abs(value) or 1.0 for value in values.values()])
        directions = [Direction({name: size}) for name, size in zip(values, sizes, strict=True)]
        tangents = differentiate_cycle(cycle.system, period, turning, directions, cycle.end, STEADY, COARSE)
        every, places = np.unique(shares, return_inverse=True)
        rows = tangents.rows_at(every * period).outputs_by[:, places].transpose(1, 2, 0)
        return self.select(rows / sizes, cycle.system.outputs.names, tangents.start / sizes)

    def _find_cycle(
        self, values: Mapping[str, float], experiment: Experiment, start: Vector | None
    ) -> tuple[Vector, Cycle]:
        """Where the positions are in the cycle, and the cycle; ModelError if it is not steady."""
        assert experiment.speed is not None
        finder = _build_finder(self.toml, self.flywheel)
        shares = find_shares(finder, experiment)
        samples = count_samples(shares)
        if start is None:
            cycle = finder.begin(values, experiment.speed, samples)
        else:
            cycle = finder.find(values, experiment.speed, start, samples)
        if cycle.change > USABLE:
            raise ModelError(f"no steady cycle: a state changes by {cycle.change:.2g} of itself over it")
        return shares, cycle


@lru_cache(maxsize=1)
def _build_finder(toml: str, flywheel: str) -> CycleFinder:
    """Once in a process."""
    return CycleFinder(SpeedSubject(parse_toml(toml), flywheel), CYCLE_TOLERANCE, STEADY)


def find_shares(finder: CycleFinder, experiment: Experiment) -> Vector:
    """Where the positions are in the cycle, from 0 to 1. Cams turn once in it."""
    assert experiment.speed is not None
    system = finder.system
    if experiment.shaft == TIME:
        return np.asarray(experiment.positions / find_period(system, experiment.speed) % 1.0)
    angles = find_angles(system)
    angle = angles.get(experiment.shaft, next(iter(angles.values())))
    evaluation = Evaluation(system)
    evaluation.outputs(0.0, system.x0)
    ports = dict(zip(system.inputs.names, evaluation.u, strict=True))
    ports |= dict(zip(system.outputs.names, evaluation.y, strict=True))
    turns = count_turns(system) if angle.source == f"{finder.subject.flywheel}.angle" else 1
    turned = angle.factor * turns * 2.0 * math.pi
    return np.asarray((experiment.positions - angle.factor * ports[angle.source]) / turned % 1.0)


def count_samples(shares: Vector) -> int:
    """Of a cycle, so that all positions are samples, if there is such a number."""
    gaps = np.diff(np.unique(np.round(np.append(shares, [0.0, 1.0]), 9)))
    least = round(1.0 / float(np.median(gaps)))
    for n in range(least, SAMPLES + 1, least):
        if np.max(np.abs(shares * n - np.round(shares * n))) <= ON_GRID * n:
            return n if n >= FEW else n * -(-FEW // n)
    return SAMPLES


@dataclass(frozen=True)
class TransientModel(Model):
    """The scenario's run from its start: all equations as one system where they are known, else coupled."""

    build: Builder

    def content(self) -> str:
        return super().content() + "".join(list_fmu_sums(self.scenario))

    def predict(
        self, values: Mapping[str, float], experiment: Experiment, start: Vector | None
    ) -> Prediction:
        scenario = build_scenario(put_parameters(parse_toml(self.toml), values))
        system = build_system(scenario)
        known = all(instance.component.ode for instance in system.instances.values())
        if known and not any(table.third_party for table in scenario.components.values()):
            return self._solve(resolve_start(scenario, system), experiment)
        return self._couple(scenario, experiment)

    def _solve(self, system: System, experiment: Experiment) -> Prediction:
        problem = SystemProblem(system, counts_energies=False)
        times, rows_of = np.unique(np.append(0.0, experiment.positions), return_inverse=True)
        z = problem.start(system.x0)
        stiff, longest = stiffness(problem, 0.0, z, times)
        states, _ = march(problem, Cvode(problem, TRANSIENT_TOLERANCE, stiff, longest), z, 0.0, times)
        outputs = observe(problem.evaluation, times, states)[1]
        return self.select(outputs[rows_of[1:]], system.outputs.names, np.zeros(0))

    def _couple(self, scenario: Scenario, experiment: Experiment) -> Prediction:
        plan = make_plan(resolve(scenario), self.build, Reporter(Console(quiet=True)), figures=False)
        rows = _Rows()
        with open_participants(plan.system, plan.participants) as participants:
            simulate(
                plan.system, participants, plan.master, plan.make_steps(), plan.stop_time, [rows],
                lines=plan.side_lines,
            )  # fmt: skip
        times, outputs = np.array(rows.times), np.array(rows.outputs)
        found = [np.interp(experiment.positions, times, column) for column in outputs.T]
        return self.select(np.array(found).T, plan.system.outputs.names, np.zeros(0))


class _Rows(Observer):
    """An observer that keeps times and outputs."""

    def __init__(self) -> None:
        self.times, self.outputs = list[float](), list[Vector]()

    def observe(self, time: float, outputs: Callable[[], Vector], step: Step) -> None:
        self.times.append(time)
        self.outputs.append(outputs().copy())


def make_model(scenario: Scenario, measured: Measured, parameters: Sequence[str], build: Builder) -> Model:
    """For data with speeds the steady cycles, else the run; MistakeError where it ends before the data, or
    one of the `parameters` that are fitted says the speed of cycles."""
    # With the numbers that oils, tables and drawings give, so that each may vary alone.
    toml = to_full_toml(scenario)
    variables = tuple(signal.variable for signal in measured.signals)
    if measured.experiments[0].speed is not None:
        flywheel = find_flywheel(scenario)
        for name in parameters:
            check_varied(name, flywheel)
        return CycleModel(toml, variables, flywheel)
    last = float(measured.experiments[0].positions.max())
    if measured.experiments[0].positions.min() < 0.0 or last > scenario.stop_time * (1.0 + 1e-9):
        raise MistakeError(
            f"data until {last:g} s: the scenario runs from 0 to {scenario.stop_time:g} s",
            Set("stop_time", f"{last:.6g} s"),
        )
    return TransientModel(toml, variables, build)


def evaluate(
    model: Model, task: Task, values: Mapping[str, float], experiment: Experiment, start: Vector | None
) -> Prediction:
    """A failure of the model, as that of a speed without cycle, is a prediction with its message."""
    try:
        found: Prediction = getattr(model, task)(values, experiment, start)
    except (ModelError, RunError, MistakeError, ArithmeticError, np.linalg.LinAlgError) as error:
        return failed(format_message(error))
    return found if np.isfinite(found.signals).all() else failed("outputs are not finite")
