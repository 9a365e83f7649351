"""Published coupling problems: the fewest doSteps for an error by tool, and our advice against the best.

Equations are our own components'; solutions are matrix exponentials.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from fmus.build import build
from orchestrator.analyses.stability.linearisation import open_linearisations
from orchestrator.analyses.stability.survey import survey
from orchestrator.errors import RunError
from orchestrator.participants import in_process
from orchestrator.run.simulation import simulate
from orchestrator.scenario.files import load
from orchestrator.scenario.system import build_system
from orchestrator.study.work_precision import methods, peers
from orchestrator.study.work_precision.methods import Method, Trace
from orchestrator.study.work_precision.problem import MAESTRO, PRECICE, CouplingProblem, build_problem
from orchestrator.study.work_precision.row import Row, build_fmus, compute_errors

# The scenario, what it changes, and how long it is coupled (s).
PROBLEMS: dict[str, tuple[str, list[str], float]] = {
    "quarter-car": ("quarter-car", [], 0.48),
    "precice-oscillator": ("two-masses", PRECICE, 0.48),
    "mass-spring-damper": ("two-masses", MAESTRO, 3.2),
}
ERRORS = (1e-2, 1e-4)
STEPS = 5  # macro steps of each method, each half of the one before
OURS = (
    Method("jacobi", "hold"),
    Method("gauss_seidel", "quadratic"),
    Method("gauss_seidel", "hermite"),
    Method("iterated", "hermite"),
    Method("gauss_seidel", "quadratic", "defect"),
)


def measure() -> Iterator[tuple[str, str]]:
    """Figures and their values, a problem after the other."""
    for name in PROBLEMS:
        yield from _measure_problem(name)


def _measure_problem(name: str) -> Iterator[tuple[str, str]]:
    problem = build_problem(name, PROBLEMS[name][2])
    problem = replace(problem, halvings=problem.halvings[:STEPS], held_halvings=problem.held_halvings[:STEPS])
    files = build_fmus(problem, lambda component, structure, kind: build(component, None, structure))
    rows = {
        method.name: [methods.measure_method(problem, files, method, s) for s in method.settings(problem)]
        for method in OURS
    }
    rows |= {peer: list(peers.measure_peer(problem, files, peer)) for peer in peers.PEERS}
    for error in ERRORS:
        found = {method: least for method, own in rows.items() if (least := _find_least(own, error))}
        shown = [f"{m} {n}" for m, n in sorted(found.items(), key=lambda item: item[1])]
        shown += [_describe_most(method, own) for method, own in rows.items() if method not in found]
        yield f"{name}, doSteps for an error of {error:g}", "; ".join(shown)
        yield f"{name}, advice for an error of {error:g}", _describe_advice(problem, error, found)


def _find_least(rows: Sequence[Row], error: float) -> int:
    """The fewest doSteps of a run with this error at most; 0 if there is none."""
    return min((row.calls for row in rows if row.error <= error), default=0)


def _describe_most(method: str, rows: Sequence[Row]) -> str:
    """Of a method that does not come to an error: its most doSteps and least error, or why there is none."""
    errors = [row.error for row in rows if np.isfinite(row.error)]
    if not errors:
        return f"{method}: {next((row.note for row in rows if row.note), 'no run')}"
    return f"{method} over {max(row.calls for row in rows)} (error {min(errors):.1e})"


def _describe_advice(problem: CouplingProblem, allowed: float, found: dict[str, int]) -> str:
    """What `analyse` advises, what a run of it has, and its doSteps over the fewest of all others."""
    scenario, settings, stop = PROBLEMS[problem.name]
    tolerance = "tolerance={" + ", ".join(f"'{output}'={allowed!r}" for output in problem.outputs) + "}"
    one = load(scenario, [*settings, f"stop_time={stop!r}", f"macro_step={problem.ladder[2]!r}", tolerance])
    system = build_system(one)
    with open_linearisations(one, system, None) as sources:
        best = survey(one, system, linearisations=sources).best
    if best is None:
        return "none"
    step = problem.duration / np.ceil(problem.duration / best.advised_step)
    trace = Trace(problem.outputs)
    units = {name: in_process(name, instance) for name, instance in system.instances.items()}
    try:
        made = simulate(system, units, best.master, float(step), problem.duration, [trace])
    except RunError as error:
        return f"{best.name}, {step:.3g} s, whose run fails: {error}"
    reached = compute_errors(problem, np.array(trace.times), np.array(trace.rows))["error"]
    least = min(found.values(), default=0)
    compared = f", {made.do_steps / least:.2g} times the fewest" if least else ""
    return f"{best.name}, {step:.3g} s: error {reached:.1e} with {made.do_steps} doSteps{compared}"
