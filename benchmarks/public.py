"""Published coupling problems: the fewest doSteps for an error by master, and our advice against the best.

Equations are our own components', or those of public FMUs. These, and published solutions, are looked for in
the folder that the environment variable TRIBOCOSIM_THIRD_PARTY names, or beside the repository. Solutions are
matrix exponentials, and the monolithic reference of the hydraulic manipulator.
"""

import os
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from rich.console import Console

from fmus.build import build
from models.monolithic import solve
from orchestrator.analyses.stability.analyse import survey_scenario
from orchestrator.errors import RunError
from orchestrator.reporter import Reporter
from orchestrator.run.plan import FmuFile, open_participants, plan_participants
from orchestrator.run.simulation import simulate
from orchestrator.scenario import Scenario, ScenarioError, build_scenario
from orchestrator.scenario.files import load
from orchestrator.scenario.system import assemble, build_system

from .coupling.methods import Method, Trace, measure_method
from .coupling.problem import (
    PROBLEMS,
    CouplingProblem,
    Row,
    build_fmus,
    build_problem,
    compute_errors,
    solve_reference,
)

VARIABLE = "TRIBOCOSIM_THIRD_PARTY"
BESIDE = Path(__file__).parents[1].parent / "shared" / "third_party"
# The quarter truck on which libcosim's issue 609 compares tools, with solvers inside that are exact enough.
TRUCK = {"chassis": "quarter_truck/Chassis.fmu", "wheel": "quarter_truck/Wheel.fmu"}
TIGHT = {"relTolerance": 1e-6, "absTolerance": 1e-6}
# The published solution of the hydraulic manipulator, by the names of its columns.
PUBLISHED = "cosim-benchmarks/hydraulicManipulator_refM2.csv"
COLUMNS = {
    "s": "links.length", "sd": "links.rate", "p1": "cylinder.pressure_1", "p2": "cylinder.pressure_2",
    "f": "cylinder.force",
}  # fmt: skip
ERRORS = (1e-2, 1e-4)
OURS = (
    Method("jacobi", "hold"),
    Method("gauss_seidel", "quadratic"),
    Method("gauss_seidel", "hermite"),
    Method("iterated", "hermite"),
    Method("gauss_seidel", "quadratic", "defect"),
)


@dataclass(frozen=True)
class Published:
    """A problem, its FMUs, and its scenario with a macro step (s) and an error allowed of all its outputs."""

    problem: CouplingProblem
    files: Mapping[str, FmuFile]
    describe: Callable[[float, float], Scenario]
    ours: Sequence[Method] = OURS
    errors: Sequence[float] = ERRORS


def measure() -> Iterator[tuple[str, str]]:
    """Figures and their values, a problem after the other."""
    for name in PROBLEMS:
        yield from _measure_problem(_build_published(name))
    yield from _measure_problem(_build_manipulator())
    if folder := find_data([PUBLISHED]):
        difference = max(compare_manipulator(folder / PUBLISHED).values())
        yield "hydraulic-manipulator, largest difference to the published solution", f"{difference:.1e}"
    else:
        yield "hydraulic-manipulator, published solution", _describe_absent([PUBLISHED])
    if folder := find_data(TRUCK.values()):
        yield from _measure_problem(_build_truck(folder))
    else:
        yield "quarter-truck", _describe_absent(TRUCK.values())


def find_data(files: Iterable[str]) -> Path | None:
    """The folder that has these files of others."""
    folders = [Path(folder) for folder in (os.environ.get(VARIABLE), BESIDE) if folder]
    return next((one for one in folders if all((one / file).is_file() for file in files)), None)


def _describe_absent(files: Iterable[str]) -> str:
    return f"not run: needs {', '.join(files)} in the folder of {VARIABLE}"


def _build_published(name: str) -> Published:
    kind, problem = PROBLEMS[name], build_problem(name)
    files = build_fmus(problem, lambda component, structure, kind: build(component, None, structure))

    def describe(step: float, allowed: float) -> Scenario:
        tolerance = "tolerance={" + ", ".join(f"'{one}'={allowed!r}" for one in problem.outputs) + "}"
        return load(
            kind.scenario, [*kind.settings, f"stop_time={kind.stop!r}", f"macro_step={step!r}", tolerance]
        )

    return Published(problem, files, describe)


def describe_manipulator(stop: float, step: float = 1e-3, allowed: float = 1e-2) -> Scenario:
    """The hydraulic manipulator, up to a time and in macro steps (s), with this error of each output."""
    components = {
        name: {"component": f"benchmarks.hydraulic_manipulator:{name}"} for name in ("links", "cylinder")
    }
    lines = [
        "cylinder.force -> links.force", "links.length -> cylinder.length", "links.rate -> cylinder.rate",
    ]  # fmt: skip
    return build_scenario(
        {
            "name": "hydraulic-manipulator",
            "stop_time": stop,
            "macro_step": step,
            "start": "given",
            "tolerance": dict.fromkeys(COLUMNS.values(), allowed),
            "connections": lines,
            "components": components,
        }
    )


def compare_manipulator(file: Path) -> dict[str, float]:
    """The largest difference to the published solution by output, over its range."""
    published = np.genfromtxt(file, delimiter=",", names=True)
    system = build_system(describe_manipulator(float(published["t"][-1])))
    solution = solve(system, published["t"])
    return {
        output: float(np.max(np.abs(solution[output] - published[column])) / np.ptp(published[column]))
        for column, output in COLUMNS.items()
    }


def _build_manipulator() -> Published:
    """Over the first second, in which the valve's motion grows."""
    outputs = tuple(COLUMNS.values())
    times = 16e-3 * np.arange(1.0, 65.0)

    def describe(step: float, allowed: float) -> Scenario:
        return describe_manipulator(float(times[-1]), step, allowed)

    system = build_system(describe(1e-3, ERRORS[0]))
    problem = CouplingProblem(
        name="hydraulic-manipulator",
        system=system,
        times=times,
        outputs=outputs,
        truth=solve_reference(system, outputs, times),
        held_halvings=(4, 5, 6, 7, 8),
    )
    files = {
        name: FmuFile(build(f"benchmarks.hydraulic_manipulator:{name}"), "") for name in system.instances
    }
    return Published(problem, files, describe)


def _build_truck(folder: Path) -> Published:
    """The quarter truck, whose equations are those of the quarter car."""
    car = build_problem("quarter-car")

    def describe(step: float, allowed: float) -> Scenario:
        tables = {
            name: {"participant": str(folder / file), "process": "shared", "parameters": TIGHT}
            for name, file in TRUCK.items()
        }
        return build_scenario(
            {
                "name": "quarter-truck",
                "stop_time": car.duration,
                "macro_step": step,
                "start": "given",
                "reference": {"enabled": False},
                "tolerance": dict.fromkeys(car.outputs, allowed),
                "connections": [
                    "chassis.velocity -> wheel.in_vel",
                    "wheel.out_spring_damper_f -> chassis.force",
                ],
                "components": tables,
            }
        )

    system = build_system(describe(car.ladder[0], ERRORS[0]))
    files = {name: FmuFile(folder / file, "") for name, file in TRUCK.items()}
    # Step control takes thousands of steps, of which each of these FMUs costs a millisecond. Their outputs
    # stay those of the last step when inputs are given after it: no master comes to the smaller error.
    fixed = [method for method in OURS if not method.estimator]
    truck = replace(car, name="quarter-truck", system=system)
    return Published(truck, files, describe, fixed, ERRORS[:1])


def _measure_problem(published: Published) -> Iterator[tuple[str, str]]:
    problem, files = published.problem, published.files
    rows = {
        method.name: [measure_method(problem, files, method, s) for s in method.settings(problem)]
        for method in published.ours
    }
    for error in published.errors:
        found = {method: least for method, own in rows.items() if (least := _find_least(own, error))}
        shown = [f"{m} {n}" for m, n in sorted(found.items(), key=lambda item: item[1])]
        shown += [_describe_most(method, own) for method, own in rows.items() if method not in found]
        yield f"{problem.name}, doSteps for an error of {error:g}", "; ".join(shown)
        yield f"{problem.name}, advice for an error of {error:g}", _describe_advice(published, error, found)


def _find_least(rows: Sequence[Row], error: float) -> int:
    """The fewest doSteps of a run with this error at most; 0 if there is none."""
    return min((row.calls for row in rows if row.error <= error), default=0)


def _describe_most(method: str, rows: Sequence[Row]) -> str:
    """Of a method that does not come to an error: its most doSteps and least error, or why there is none."""
    errors = [row.error for row in rows if np.isfinite(row.error)]
    if not errors:
        return f"{method}: {next((row.note for row in rows if row.note), 'no run')}"
    return f"{method} over {max(row.calls for row in rows)} (error {min(errors):.1e})"


def _describe_advice(published: Published, allowed: float, found: dict[str, int]) -> str:
    """What `analyse` advises, what a run of it has, and its doSteps over the fewest of all others."""
    problem = published.problem
    one = published.describe(problem.ladder[2], allowed)
    try:
        best = survey_scenario(one, [], Reporter(Console(quiet=True))).best
    except ScenarioError as error:
        return f"refused: {error}"
    if best is None:
        return "none"
    step = problem.duration / np.ceil(problem.duration / best.advised_step)
    trace = Trace(problem.outputs)
    try:
        assembly = assemble(one)
        system, plans = assembly.system, plan_participants(one, assembly.linear, None)
        with open_participants(system, plans) as units:
            made = simulate(system, units, best.master, float(step), problem.duration, [trace])
    except RunError as error:
        return f"{best.name}, {step:.3g} s, whose run fails: {error}"
    reached = compute_errors(problem, np.array(trace.times), np.array(trace.rows))
    least = min(found.values(), default=0)
    compared = f", {made.do_steps / least:.2g} times the fewest" if least else ""
    return (
        f"{best.name}, {step:.3g} s: error {max(reached.values()):.1e} with {made.do_steps} doSteps{compared}"
    )
