"""One run of a scenario: coupled, reference, comparison, files."""

from __future__ import annotations

import time as clock
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from importlib import metadata
from pathlib import Path
from typing import TYPE_CHECKING

from models.quantities import Vector
from models.system import ModelError, System

from . import assembly
from .comparison import compare, largest_uncertainty, verdict
from .errors import RunError
from .interruption import Interruption
from .journal import Recorded, journals
from .output_folder import CSV, FIGURES, RESULT, SCENARIO, SUMMARY, files, prepared
from .recording import CsvRecorder, ResultRecorder
from .report import Reporter
from .results import ResultFile
from .scenario import Scenario
from .scenario_files import written
from .simulation import simulate
from .stepping import Step
from .summary import FAILED, INTERRUPTED, NOT_COMPARED, OUTSIDE, WITHIN, Summary
from .unfinished import clear
from .validity import excursions
from .watchdog import watching

if TYPE_CHECKING:
    from models.monolithic import Reference

# Records compared with the reference (and drawn) at most: bounds memory, and is dense in any cycle.
COMPARED_RECORDS = 100_000


def run(
    scenario: Scenario,
    out: Path,
    build: assembly.Builder,
    reporter: Reporter,
    overwrite: bool = False,
    figures: bool = True,
) -> Summary:
    """Run and write everything into `out`. The summary's `exit_status` is 0 only within the tolerance.

    A run that fails or is interrupted leaves what was recorded, marked incomplete; its message is in the
    summary. Raises ScenarioError, ModelError or OutputFolderError before anything is written.
    """
    system = assembly.system_of(scenario)
    with prepared(out, overwrite) as folder:
        (out / SCENARIO).write_text(written(scenario), "utf-8")
        return _run(scenario, system, out, folder, build, reporter, figures)


def _run(
    scenario: Scenario,
    system: System,
    out: Path,
    folder: Path,
    build: assembly.Builder,
    reporter: Reporter,
    figures: bool,
) -> Summary:
    """`folder` is that of the unfinished run in `out`."""
    began = clock.perf_counter()
    summary = Summary(
        scenario=scenario.name,
        description=scenario.description,
        version=metadata.version("tribocosim"),
        master=scenario.master.model_dump(),
        macro_step=scenario.macro_step,
        tolerance=dict(scenario.tolerance),
    )
    try:
        with _outcome(summary):
            _stages(scenario, system, out, folder, build, figures, summary, reporter)
    finally:
        summary.wall_time_s = clock.perf_counter() - began
        summary.write(out / SUMMARY)
    if (out / RESULT).exists():
        clear(folder)
    if summary.errors:
        reporter.errors(summary.errors)
    reporter.end(summary, out, files(out))
    return summary


def _stages(
    scenario: Scenario,
    system: System,
    out: Path,
    folder: Path,
    build: assembly.Builder,
    figures: bool,
    summary: Summary,
    reporter: Reporter,
) -> None:
    with reporter.stage("FMUs"):
        fmus = assembly.fmu_files(scenario, build)
    summary.fmus = {name: file.sha256 for name, file in fmus.items()}
    coupled = False
    with _outcome(summary):
        system = assembly.at_start(scenario, system)
        _coupled(scenario, system, fmus, folder, out / CSV, summary, reporter)
        coupled = True
    with ResultFile(out / RESULT, _attributes(scenario, summary)) as result:
        with reporter.stage("result file"):
            for name, path in journals(folder).items():
                result.take(name, Recorded(path))
        if coupled:
            with _outcome(summary):
                _judged(scenario, system, result, summary, reporter)
        result.finish(summary.complete, summary.message)
        if figures and summary.exit_status != INTERRUPTED and result.length("coupled") > 1:
            from . import plots

            with reporter.stage("figures"):
                title = scenario.name if summary.complete else f"{scenario.name} (incomplete)"
                plots.draw(result, out / FIGURES, title, scenario)


def _judged(
    scenario: Scenario, system: System, result: ResultFile, summary: Summary, reporter: Reporter
) -> None:
    """What the finished coupled run comes to."""
    rows = slice(None, None, compared_every(result))
    summary.validity = excursions(system, lambda names: result.read("coupled", names, rows))
    if scenario.reference.enabled:
        _compared(scenario, system, result, summary, reporter)
    else:
        summary.verdict = "not compared: the reference is switched off (reference.enabled)"
        summary.exit_status = NOT_COMPARED
    summary.complete, summary.message = True, "complete"


@contextmanager
def _outcome(summary: Summary) -> Iterator[None]:
    """Put what ends a run early into the summary."""
    try:
        yield
    except KeyboardInterrupt:
        summary.message, summary.exit_status = "incomplete: interrupted", INTERRUPTED
    except (RunError, ModelError, ValueError, ArithmeticError) as error:
        summary.message, summary.exit_status = f"incomplete: {error}", FAILED
    else:
        return
    summary.complete = False


def _attributes(scenario: Scenario, summary: Summary) -> dict[str, str]:
    packages = ("tribocosim", "numpy", "scipy", "numba", "scikit-sundae", "fmpy", "pythonfmu")
    versions = ", ".join(f"{name} {metadata.version(name)}" for name in packages)
    sums = "\n".join(f"{name} {sha256}" for name, sha256 in summary.fmus.items())
    return {
        "title": scenario.description or scenario.name,
        "scenario": scenario.name,
        "scenario_toml": written(scenario),
        "versions": versions,
        "fmu_sha256": sums or "none",
    }


def _coupled(
    scenario: Scenario,
    system: System,
    fmus: dict[str, assembly.FmuFile],
    folder: Path,
    csv: Path,
    summary: Summary,
    reporter: Reporter,
) -> None:
    every = scenario.record_every
    quantities = assembly.output_quantities(system)
    counter = _Counter()
    stage = reporter.stage(f"coupled run, master {scenario.master.name}", scenario.stop_time)
    recorders = [ResultRecorder(folder, quantities, every), CsvRecorder(csv, every)]
    with watching(scenario, csv.with_name(SUMMARY), summary) as watchdog:
        participants = assembly.participants_of(scenario, system, fmus, watchdog.made)
        try:
            with stage as bar, Interruption() as interruption:
                statistics = simulate(
                    system,
                    participants,
                    scenario.made_master(),
                    scenario.made_steps(),
                    scenario.stop_time,
                    [*watchdog.observers, *recorders, counter, bar, interruption],
                )
        finally:
            summary.macro_steps, summary.iterations = max(0, counter.steps), counter.iterations
            summary.coupled_time_s = counter.time_s
            for participant in participants.values():
                participant.close()
    summary.rejected_steps = statistics.rejected_steps
    summary.iterations = statistics.iterations
    summary.coupled_time_s = statistics.coupled_time_s


class _Counter:
    """What a run came to that did not live to return its statistics."""

    steps = -1
    iterations = 0
    time_s = 0.0

    def begin(self, names: Sequence[str]) -> None:
        self._began = clock.perf_counter()

    def observe(self, time: float, outputs: Callable[[], Vector], step: Step) -> None:
        self.steps += 1
        self.iterations += step.iterations

    def end(self, complete: bool, message: str) -> None:
        self.time_s = clock.perf_counter() - self._began


def compared_every(result: ResultFile) -> int:
    """Records of the coupled run from one compared to the next."""
    return -(-result.length("coupled") // COMPARED_RECORDS)


def _compared(
    scenario: Scenario, system: System, result: ResultFile, summary: Summary, reporter: Reporter
) -> None:
    rows = slice(None, None, compared_every(result))
    names = assembly.compared(scenario, system)
    coupled = result.read("coupled", ["time", *names], rows)
    reference = _reference(scenario, system, coupled["time"], reporter)
    summary.reference_time_s = reference.wall_time_s
    quantities = assembly.output_quantities(system)
    result.write("reference", reference.times, quantities, reference.outputs)
    result.attribute("reference", "tolerance", scenario.reference.tolerance)
    del coupled["time"]
    columns = {name: reference.outputs[:, system.outputs.names.index(name)] for name in names}
    nominal = {name: quantities[name].nominal for name in names}
    summary.errors = compare(
        reference.times, coupled, columns, reference.uncertainty, nominal, scenario.tolerance
    )
    for name, error in summary.errors.items():
        result.attribute(f"reference/{name}", "uncertainty_rms", error.uncertainty.rms)
    summary.reference_uncertainty = largest_uncertainty(summary.errors)
    within, summary.verdict = verdict(summary.errors)
    summary.exit_status = WITHIN if within else OUTSIDE


def _reference(scenario: Scenario, system: System, times: Vector, reporter: Reporter) -> Reference:
    from models.monolithic import solve

    with reporter.stage("monolithic reference", scenario.stop_time) as bar:
        return solve(system, times, tolerance=scenario.reference.tolerance, x0=system.x0, progress=bar.show)
