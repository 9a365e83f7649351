"""Regret of `--master auto`: its doSteps over the fewest with which another choice is within the tolerance.

Problems are shipped scenarios and published couplings, with the errors that they allow; choices are all
masters with all signals over macro steps, and step control over tolerances. Components run in this process.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property, partial

import numpy as np
from rich.console import Console
from scipy.interpolate import make_interp_spline

from models.core.difference import difference
from models.core.quantities import Vector
from models.core.system import System
from models.monolithic.trajectory import compute_trajectory
from orchestrator.analyses.stability.choice import LEAST, choose
from orchestrator.engine.coupling import Coupling
from orchestrator.engine.observer import Observer
from orchestrator.engine.step import Step
from orchestrator.errors import MistakeError, RunError
from orchestrator.masters import MASTERS, Master
from orchestrator.reporter import Reporter
from orchestrator.run.plan import open_participants, plan_participants
from orchestrator.run.simulation import simulate
from orchestrator.scenario import Scenario
from orchestrator.scenario.files import load
from orchestrator.scenario.master_table import AUTO, MasterTable
from orchestrator.scenario.system import Resolved, resolve
from orchestrator.stepping import FixedSteps, StepControl, Stepper, control_steps

from .published import TWO_MASSES, describe_manipulator, describe_two_masses

# Steps of a ladder, each shorter by RATIO, from the longest that has LEAST steps in the run.
RATIO = math.sqrt(2.0)
# Instants of the true solution, for each macro step of the scenario and at most; its tolerance.
FINER, INSTANTS, EXACT = 2, 200_000, 1e-11
SAMPLES = 1000


@dataclass(frozen=True)
class Problem:
    """A scenario, and the true values of the outputs that have a tolerance."""

    resolved: Resolved
    times: Vector
    truth: Vector

    @property
    def scenario(self) -> Scenario:
        return self.resolved.scenario

    @property
    def system(self) -> System:
        return self.resolved.system

    def measure_error(self, trace: Trace) -> float:
        """The largest relative RMS error over what is allowed."""
        at = np.array(trace.times)
        samples = np.linspace(0.0, self.scenario.stop_time, SAMPLES + 1)[1:]
        after = np.minimum(np.searchsorted(at, samples * (1.0 - 1e-9)), len(at) - 1)
        near = np.unique([np.maximum(after - 1, 0), after])
        worst = 0.0
        true, exact = self.course(at[near]), self.course(samples)
        for column, allowed in enumerate(self.scenario.tolerance.values()):
            off = np.array(trace.rows)[near, column] - true[:, column]
            error = np.interp(samples, [0.0, *at[near]], [0.0, *off])
            found = difference(exact[:, column] + error, exact[:, column])
            worst = max(worst, found.relative_rms / allowed)
        return worst

    @cached_property
    def course(self) -> Callable[[Vector], Vector]:
        """The true outputs at any times: a cubic spline, or straight lines where impacts make them jump."""
        jumps = any(i.component.events for i in self.system.instances.values())
        spline: Callable[[Vector], Vector] = make_interp_spline(self.times, self.truth, k=1 if jumps else 3)
        return spline


def solve_problem(scenario: Scenario) -> Problem:
    """The problem with its true solution."""
    resolved = resolve(scenario)
    system = resolved.system
    count = min(INSTANTS, FINER * round(scenario.stop_time / scenario.macro_step))
    times = np.linspace(0.0, scenario.stop_time, count + 1)
    outputs = compute_trajectory(system, times, EXACT).outputs
    columns = [system.outputs.names.index(name) for name in scenario.tolerance]
    return Problem(resolved, times, outputs[:, columns])


@dataclass(frozen=True)
class Outcome:
    """A run: its choice, doSteps, and largest error over what is allowed (NaN and a note if it failed)."""

    choice: str
    steps: int = 0
    error: float = math.nan
    note: str = ""

    @property
    def good(self) -> bool:
        return self.error <= 1.0


TOO_MANY = "more doSteps than the best"


@dataclass
class Trace(Observer):
    """An observer that records some outputs at the end of every step, of which there are at most `most`
    calls of doStep."""

    names: Sequence[str]
    most: float = math.inf
    times: list[float] = field(default_factory=list)
    rows: list[Vector] = field(default_factory=list)

    def watch(self, coupling: Coupling) -> None:
        self._calls = coupling.calls

    def begin(self, names: Sequence[str]) -> None:
        self._columns = [list(names).index(name) for name in self.names]

    def observe(self, time: float, outputs: Callable[[], Vector], step: Step) -> None:
        if step.length > 0.0:
            self.times.append(time)
            self.rows.append(outputs()[self._columns])
        if self._calls.sum() > self.most:
            raise RunError(TOO_MANY)


def run(problem: Problem, name: str, master: Master, steps: Stepper, most: float = math.inf) -> Outcome:
    """Run the problem's components with a master and these steps, and at most so many doSteps."""
    scenario = problem.scenario
    trace = Trace(list(scenario.tolerance), most)
    assembly = problem.resolved.assembly
    plans = plan_participants(scenario, assembly.linear, None)
    try:
        with open_participants(problem.system, plans) as units:
            made = simulate(
                problem.system, units, master, steps, scenario.stop_time, [trace], lines=assembly.side_lines
            )
    except (RunError, MistakeError) as error:
        return Outcome(name, note=str(error))
    return Outcome(name, made.do_steps, problem.measure_error(trace))


# Masters and signals, the usual best first: what takes longer than the best so far is not run.
FIXED = (
    ("gauss_seidel", "hermite"),
    ("gauss_seidel", "quadratic"),
    ("iterated", "hermite"),
    ("gauss_seidel", "linear"),
    ("jacobi", "hermite"),
    ("jacobi", "quadratic"),
    ("iterated", "quadratic"),
)
CONTROLLED = (
    ("gauss_seidel", "hermite", "defect"),
    ("gauss_seidel", "quadratic", "defect"),
    ("iterated", "hermite", "predictor_corrector"),
    ("gauss_seidel", "hermite", "step_doubling"),
)
# Tolerances of step control are ten to these powers.
POWERS = tuple(-0.5 * k for k in range(2, 15))


def find_best(problem: Problem, told: Callable[[Outcome], None] = lambda one: None) -> Outcome | None:
    """The choice with the fewest doSteps that is within the tolerance."""
    best: Outcome | None = None
    scenario, longest = problem.scenario, math.inf
    most = 8.0 * len(scenario.components) * scenario.stop_time / scenario.macro_step

    def attempt(name: str, master: Master, steps: Stepper) -> bool:
        """Whether steps were short enough."""
        nonlocal best
        made = run(problem, name, master, steps, best.steps if best else most)
        told(made)
        if made.good:
            best = made
        return made.good or made.note == TOO_MANY

    attempt("its own", scenario.build_master(), scenario.build_steps())
    for name, signal in FIXED:
        master = MASTERS[name](extrapolation=signal)
        step = scenario.stop_time / LEAST
        least = len(scenario.components) * (1.0 + master.implicit) * scenario.stop_time
        while step > scenario.macro_step / 32.0 and not (best and least / step > best.steps):
            if attempt(f"{name} {signal} {step:.3g} s", master, FixedSteps(step, scenario.event_tolerance)):
                longest = min(longest, step)
                break
            step /= RATIO
    for name, signal, estimator in CONTROLLED:
        for limit in (math.inf, RATIO * longest, longest) if estimator == "defect" else (math.inf,):
            for power in POWERS:
                relative = 10.0**power
                master = MASTERS[name](extrapolation=signal)
                if master.implicit:
                    master = replace(master, tolerance=0.3 * relative)
                most_of = scenario.stop_time / LEAST
                first = min(scenario.macro_step, most_of)
                control = StepControl(
                    estimator, relative, relative, maximum_step=max(min(limit, most_of), first)
                )
                told_as = f"{name} {signal} {estimator} {relative:.1e} up to {limit:.3g} s"
                if attempt(told_as, master, control_steps(first, control)):
                    break
    return best


# Shipped scenarios, over the time (s) in which what they show happens; None: the whole.
SHIPPED: dict[str, float | None] = {
    "quarter-car": None,
    "two-masses": None,
    "slider-crank": None,
    "my-cam": 0.04,
    "valve-train": 0.03,
    "valve-train-flexible": 0.05,
    "valve-train-high-speed": 0.02,
    "run-up": 0.1,
    "finger-follower": 0.06,
    "finger-follower-hla": 0.06,
    "roller-finger": 0.03,
    "roller-slip": 0.024,
    "direct-acting-hla": 0.06,
    "qin2000-train": 0.06,
    "pushrod-train": 0.03,
    "seat-and-lash": 0.03,
    "exhaust-valve": 0.03,
    "coil-clash": 0.02,
    "valve-stem": 0.03,
    "shaft-in-bearings": 0.03,
    "piston-slap": 0.06,
    "engine": 0.06,
}
# Published couplings, with the error that each of their states may have.
ALLOWED = 1e-3


def list_scenarios() -> dict[str, Callable[[], Scenario]]:
    """The problems by name."""
    found = {name: partial(_load_shipped, name, stop) for name, stop in SHIPPED.items()}
    published = {name: partial(describe_two_masses, name, ALLOWED) for name in TWO_MASSES}
    manipulator = partial(describe_manipulator, 64 * 16e-3, ALLOWED)
    return {**published, "hydraulic-manipulator": manipulator, **found}


def _load_shipped(name: str, stop: float | None) -> Scenario:
    return load(name, [] if stop is None else [f"stop_time={stop!r}"])


def run_chosen(problem: Problem) -> Outcome:
    """The run that `auto` chooses; a note if it refuses."""
    asked = problem.scenario.model_copy(update={"master": MasterTable(name=AUTO), "step_control": None})
    try:
        found = choose(problem.resolved.with_master_of(asked), Reporter(Console(quiet=True)))
    except MistakeError as error:
        return Outcome("refused", note=str(error))
    chosen = found.scenario
    return run(problem, str(chosen.master.chosen), chosen.build_master(), chosen.build_steps())


def measure(names: Sequence[str] = ()) -> Iterator[tuple[str, str]]:
    """Figures and their values, a problem after the other."""
    scenarios = list_scenarios()
    for name in names or scenarios:
        problem = solve_problem(scenarios[name]())
        own = run_chosen(problem)
        best = find_best(problem)
        fewest = f"{best.choice}: {best.steps}" if best else "none within the tolerance"
        said = own.note or f"{own.steps} doSteps, {own.error:.2g} of the tolerance"
        ratio = f"{own.steps / best.steps:.2f} times " if best and own.good else ""
        yield f"{name}, auto over the best in hindsight", f"{said}; {ratio}{fewest}"
