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
from .errors import MistakeError, RunError
from .interruption import Interruption
from .recording import CsvRecorder, ResultRecorder
from .report import Reporter
from .results import ResultFile
from .scenario import Scenario
from .scenario_files import written
from .simulation import simulate
from .summary import FAILED, INTERRUPTED, NOT_COMPARED, OUTSIDE, WITHIN, Summary
from .validity import excursions

if TYPE_CHECKING:
    from models.monolithic import Reference

# Records compared with the reference (and drawn) at most: bounds memory, and is dense in any cycle.
COMPARED_RECORDS = 100_000

RESULT, CSV, SCENARIO, SUMMARY, FIGURES = (
    "result.nc",
    "coupled.csv",
    "scenario.toml",
    "summary.json",
    "figures",
)


class OutputFolderError(MistakeError):
    """The output folder cannot take a result."""


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
    began = clock.perf_counter()
    system = assembly.system_of(scenario)
    prepare(out, overwrite)
    summary = Summary(
        scenario=scenario.name,
        description=scenario.description,
        version=metadata.version("tribocosim"),
        master=scenario.master.model_dump(),
        macro_step=scenario.macro_step,
        tolerance=dict(scenario.tolerance),
    )
    (out / SCENARIO).write_text(written(scenario), "utf-8")
    try:
        with _outcome(summary):
            _stages(scenario, system, out, build, figures, summary, reporter)
    finally:
        summary.wall_time_s = clock.perf_counter() - began
        summary.write(out / SUMMARY)
    if summary.errors:
        reporter.errors(summary.errors)
    reporter.end(summary, out, _files(out))
    return summary


def _stages(
    scenario: Scenario,
    system: System,
    out: Path,
    build: assembly.Builder,
    figures: bool,
    summary: Summary,
    reporter: Reporter,
) -> None:
    with reporter.stage("FMUs"):
        files = assembly.fmu_files(scenario, build)
    summary.fmus = {name: file.sha256 for name, file in files.items()}
    result = ResultFile(out / RESULT, _attributes(scenario, summary))
    try:
        with _outcome(summary):
            system = assembly.at_start(scenario, system)
            _coupled(scenario, system, files, result, out / CSV, summary, reporter)
            rows = slice(None, None, compared_every(result))
            summary.validity = excursions(system, lambda names: result.read("coupled", names, rows))
            if scenario.reference.enabled:
                _compared(scenario, system, result, summary, reporter)
            else:
                summary.verdict = "not compared: the reference is switched off (reference.enabled)"
                summary.exit_status = NOT_COMPARED
            summary.complete, summary.message = True, "complete"
        result.finish(summary.complete, summary.message)
        if figures and summary.exit_status != INTERRUPTED and result.length("coupled") > 1:
            from . import plots

            with reporter.stage("figures"):
                title = scenario.name if summary.complete else f"{scenario.name} (incomplete)"
                plots.draw(result, out / FIGURES, title, scenario)
    finally:
        result.close()


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


def spare(source: Path, scenario: Scenario, out: Path) -> None:
    """OutputFolderError if the result's own scenario file would replace `source` by something else."""
    target = out / SCENARIO
    if target.exists() and target.samefile(source) and source.read_text("utf-8") != written(scenario):
        raise OutputFolderError(
            f"{target}: is the scenario itself, which a result here would replace; choose another folder "
            "with --out"
        )


def prepare(out: Path, overwrite: bool) -> None:
    """Make the folder; a result in it is removed if `overwrite`, and refused otherwise."""
    if out.exists() and not out.is_dir():
        raise OutputFolderError(f"{out}: is a file; choose a folder with --out")
    held = [out / name for name in (RESULT, CSV, SCENARIO, SUMMARY) if (out / name).exists()]
    held += sorted((out / FIGURES).glob("*.png"))
    if held and not overwrite:
        raise OutputFolderError(
            f"{out}: already holds a result ({held[0].name}); choose another folder with --out, "
            "or replace it with --overwrite"
        )
    try:
        for file in held:
            file.unlink()
        out.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise OutputFolderError(
            f"{out}: cannot be written ({error.strerror}); choose another --out"
        ) from None


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
    files: dict[str, assembly.FmuFile],
    result: ResultFile,
    csv: Path,
    summary: Summary,
    reporter: Reporter,
) -> None:
    every = scenario.record_every
    quantities = assembly.output_quantities(system)
    participants = assembly.participants_of(scenario, system, files)
    counter = _Counter()
    stage = reporter.stage(f"coupled run, master {scenario.master.name}", scenario.stop_time)
    recorders = [ResultRecorder(result, quantities, every), CsvRecorder(csv, every)]
    try:
        with stage as bar, Interruption() as interruption:
            statistics = simulate(
                system,
                participants,
                scenario.master.made(),
                scenario.macro_step,
                scenario.stop_time,
                [*recorders, counter, bar, interruption],
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

    def observe(self, time: float, outputs: Callable[[], Vector], iterations: int) -> None:
        self.steps += 1
        self.iterations += iterations

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
    summary.errors = compare(coupled, columns, reference.uncertainty, nominal, scenario.tolerance)
    for name, error in summary.errors.items():
        result.attribute(f"reference/{name}", "uncertainty_rms", error.uncertainty.rms)
    summary.reference_uncertainty = largest_uncertainty(summary.errors)
    within, summary.verdict = verdict(summary.errors)
    summary.exit_status = WITHIN if within else OUTSIDE


def _reference(scenario: Scenario, system: System, times: Vector, reporter: Reporter) -> Reference:
    from models.monolithic import solve

    with reporter.stage("monolithic reference", scenario.stop_time) as bar:
        return solve(system, times, tolerance=scenario.reference.tolerance, x0=system.x0, progress=bar.show)


def _files(out: Path) -> list[Path]:
    found = [out / name for name in (SUMMARY, RESULT, CSV, SCENARIO)]
    return [path for path in [*found, *sorted((out / FIGURES).glob("*.png"))] if path.exists()]
