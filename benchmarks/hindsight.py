"""Regret of `--master auto`: its doSteps over the fewest with which another choice is within the tolerance.

Problems are shipped scenarios, published couplings and FMUs of another tool (in the folder that
TRIBOCOSIM_THIRD_PARTY names), with the errors that they allow; choices are all masters with all signals over
macro steps, and step control over tolerances. Our components run in this process.
"""

from __future__ import annotations

import math
import os
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from time import process_time

import numpy as np
from rich.console import Console

from models.core.system import ModelError
from models.monolithic.trajectory import compute_trajectory
from orchestrator.analyses.stability.choice import LEAST, apply, describe, find_choice
from orchestrator.analyses.stability.trajectory import run_course
from orchestrator.analyses.stability.trial import TOO_MANY, Outcome, Trial
from orchestrator.errors import MistakeError, RunError
from orchestrator.masters import MASTERS, Master
from orchestrator.reporter import Reporter
from orchestrator.run.plan import open_participants, plan_participants
from orchestrator.scenario import Scenario
from orchestrator.scenario.capabilities import list_foreign
from orchestrator.scenario.files import load
from orchestrator.scenario.master_table import AUTO, MasterTable
from orchestrator.scenario.system import resolve
from orchestrator.stepping import FixedSteps, StepControl, Stepper, control_steps

from .published import TWO_MASSES, describe_drive, describe_manipulator, describe_two_masses

# Steps of a ladder, each shorter by RATIO, from the longest that has LEAST steps in the run.
RATIO = math.sqrt(2.0)
# Instants of the true solution, for each macro step of the scenario and at most; its tolerance.
FINER, INSTANTS, EXACT = 2, 200_000, 1e-11
# FMUs without known equations are coupled in steps so much shorter.
FINEST = 8


def solve_problem(scenario: Scenario) -> Trial:
    """The problem with its true solution."""
    resolved = resolve(scenario)
    system = resolved.system
    count = min(INSTANTS, FINER * round(scenario.stop_time / scenario.macro_step))
    times = np.linspace(0.0, scenario.stop_time, count + 1)
    if list_foreign(scenario):
        plans = plan_participants(scenario, resolved.assembly.linear, None)
        finest = np.linspace(0.0, scenario.stop_time, FINEST * count + 1)
        with open_participants(system, plans) as units:
            outputs = run_course(
                system, units, MASTERS["gauss_seidel"](), finest, lambda share: None
            ).outputs[::FINEST]
    else:
        outputs = compute_trajectory(system, times, EXACT).outputs
    columns = [system.outputs.names.index(name) for name in scenario.tolerance]
    return Trial(resolved, times, outputs[:, columns])


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


def find_best(
    problem: Trial, best: Outcome | None = None, told: Callable[[Outcome], None] = lambda one: None
) -> Outcome | None:
    """The choice with the fewest doSteps that is within the tolerance; `best` if none needs fewer."""
    scenario, longest = problem.resolved.scenario, math.inf
    most = 8.0 * len(scenario.components) * scenario.stop_time / scenario.macro_step

    def attempt(name: str, master: Master, steps: Stepper) -> bool:
        """Whether steps were short enough."""
        nonlocal best
        made = problem.run(name, master, steps, best.steps if best else most)
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
        limits = {math.inf, RATIO * longest, longest} if estimator == "defect" else {math.inf}
        for limit in sorted(limits, reverse=True):
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
    "nonlinear-loop": None,
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
    found["hydraulic-manipulator"] = partial(describe_manipulator, 64 * 16e-3, ALLOWED)
    exact = "tolerance={'first.position'=1e-5,'second.position'=1e-5}"
    found["two-masses, 1e-5"] = partial(load, "two-masses", [exact])
    if folder := os.environ.get("TRIBOCOSIM_THIRD_PARTY"):
        found["drive-train"] = partial(describe_drive, Path(folder, "fmpy"))
    return {**published, **found}


def _load_shipped(name: str, stop: float | None) -> Scenario:
    return load(name, [] if stop is None else [f"stop_time={stop!r}"])


def run_chosen(problem: Trial) -> tuple[Outcome, int]:
    """The run that `auto` chooses, a note if it refuses; and the doSteps of the runs that it tried."""
    resolved, scenario = problem.resolved, problem.resolved.scenario
    changes = {"master": MasterTable(name=AUTO), "step_control": None}
    asked = resolved.with_master_of(scenario.model_copy(update=changes))
    try:
        choice = find_choice(asked, Reporter(Console(quiet=True)))
    except (MistakeError, ModelError, RunError) as error:
        return Outcome("refused", note=str(error)), 0
    chosen = apply(asked.scenario, choice)
    return problem.run(describe(choice), chosen.build_master(), chosen.build_steps()), choice.tried


def measure(names: Sequence[str] = ()) -> Iterator[tuple[str, str]]:
    """Figures and their values, a problem after the other."""
    scenarios = list_scenarios()
    for name in names or scenarios:
        problem, began = solve_problem(scenarios[name]()), process_time()
        own, tried = run_chosen(problem)
        spent = process_time() - began - own.seconds
        best = find_best(problem, own if own.good else None)
        said = own.note or f"{own.steps} doSteps, {own.error:.2g} of the tolerance"
        if best and own.good:
            ratio = own.steps / best.steps
            said += f"; {ratio:.2f} times {best.choice}: {best.steps}" if ratio > 1.0 else "; none is fewer"
        elif best:
            said += f"; {best.choice}: {best.steps}"
        said += f"; chosen by {tried} doSteps, in {spent:.1f} s before a run of {own.seconds:.2g} s"
        yield f"{name}, auto over the best in hindsight", said
