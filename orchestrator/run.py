"""One run of a scenario: coupled, reference, comparison, files."""

from __future__ import annotations

import time as clock
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from importlib import metadata
from pathlib import Path
from typing import TYPE_CHECKING

from models.quantities import Vector
from models.system import ModelError, System

from . import assembly
from .checkpoint import NAME as CHECKPOINT
from .checkpoint import Checkpoints, Identity
from .comparison import compare, largest_uncertainty, verdict
from .diagnosis import Facts, diagnosed, steps_of, suggestions
from .energy import Ledger, Trimmed, counted
from .errors import CheckpointError, RunError
from .interruption import Interruption
from .journal import Recorded, journals
from .notices import notices
from .output_folder import CSV, FIGURES, RESULT, SCENARIO, SUMMARY, files, prepared
from .plain_data import Plain
from .recording import CsvRecorder, ResultRecorder
from .replacement import replace
from .report import Reporter
from .results import ResultFile
from .scenario import Scenario
from .scenario_files import written
from .simulation import Observer, simulate
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
        replace(out / SCENARIO, written(scenario).encode())
        for line in notices(scenario):
            reporter.line(line)
        return carry_out(Job(scenario, system, out, folder, build, reporter, figures))


@dataclass(frozen=True)
class Job:
    """A run to be carried out. `folder` is that of what is unfinished in `out`; `resumed` is a checkpoint."""

    scenario: Scenario
    system: System
    out: Path
    folder: Path
    build: assembly.Builder
    reporter: Reporter
    figures: bool
    resumed: tuple[Identity, Plain] | None = None


def carry_out(job: Job) -> Summary:
    """Run from the start or the checkpoint to the end, and write everything.

    CheckpointError if the run cannot go on from the checkpoint; nothing that it needs is changed then.
    """
    began = clock.perf_counter()
    summary = begun(job.scenario)
    refused = False
    try:
        with _outcome(summary, job.out):
            _stages(job, summary)
    except CheckpointError:
        refused = True
        raise
    finally:
        if not refused:
            summary.wall_time_s = clock.perf_counter() - began
            summary.resumable &= (job.folder / CHECKPOINT).exists()
            summary.write(job.out / SUMMARY)
    if not summary.resumable and (job.out / RESULT).exists():
        clear(job.folder)
    if summary.errors:
        job.reporter.errors(summary.errors)
    job.reporter.end(summary, job.out, files(job.out))
    return summary


def begun(scenario: Scenario) -> Summary:
    """The summary of a run of which nothing is known yet."""
    return Summary(
        scenario=scenario.name,
        description=scenario.description,
        version=metadata.version("tribocosim"),
        master=scenario.master.model_dump(),
        macro_step=scenario.macro_step,
        tolerance=dict(scenario.tolerance),
    )


def _stages(job: Job, summary: Summary) -> None:
    with job.reporter.stage("FMUs"):
        fmus = assembly.fmu_files(job.scenario, job.build)
    summary.fmus = {name: file.sha256 for name, file in fmus.items()}
    identity = Identity.of(job.out / SCENARIO, summary.fmus)
    if job.resumed:
        identity.check(job.resumed[0], job.out)
    system, coupled = job.system, False
    with _outcome(summary, job.out):
        system = assembly.at_start(job.scenario, system)
        _coupled(job, system, fmus, identity, summary)
        coupled = True
    with written_result(job, summary) as result:
        if coupled:
            with _outcome(summary, job.out):
                _judged(job.scenario, system, result, summary, job.reporter)


@contextmanager
def written_result(job: Job, summary: Summary) -> Iterator[ResultFile]:
    """The result of what has been recorded, finished after the block as the summary says, and drawn."""
    with ResultFile(job.out / RESULT, _attributes(job.scenario, summary)) as result:
        with job.reporter.stage("result file"):
            for name, path in journals(job.folder).items():
                result.take(name, Recorded(path))
        _diagnosed(job.scenario, result, summary)
        yield result
        result.finish(summary.complete, summary.message)
        if job.figures and summary.exit_status != INTERRUPTED and result.length("coupled") > 1:
            from . import plots

            name = job.scenario.name
            with job.reporter.stage("figures"):
                title = name if summary.complete else f"{name} (incomplete)"
                plots.draw(result, job.out / FIGURES, title, job.scenario)


def _diagnosed(scenario: Scenario, result: ResultFile, summary: Summary) -> None:
    """What limited the steps, of an incomplete run too."""
    steps = steps_of(result)
    summary.steps = diagnosed(steps, summary.do_steps)
    if summary.steps:
        summary.rejected_steps = summary.steps.rejected
        summary.suggestions = suggestions(Facts(summary.steps, steps, scenario))


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
    summary.complete, summary.message, summary.resumable = True, "complete", False


@contextmanager
def _outcome(summary: Summary, out: Path) -> Iterator[None]:
    """Put what ends a run early into the summary."""
    try:
        yield
    except CheckpointError:
        raise
    except KeyboardInterrupt:
        summary.message, summary.exit_status = "incomplete: interrupted", INTERRUPTED
    except OSError as error:
        reason = f"{error.filename or out}: {error.strerror or error}"
        summary.message, summary.exit_status = f"incomplete: {reason}", FAILED
    except (RunError, ModelError, ValueError, ArithmeticError) as error:
        summary.message, summary.exit_status = f"incomplete: {error}", FAILED
        summary.resumable = False  # it would fail again
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
    job: Job, system: System, fmus: dict[str, assembly.FmuFile], identity: Identity, summary: Summary
) -> None:
    scenario, every = job.scenario, job.scenario.record_every
    quantities = assembly.output_quantities(system)
    recorders: list[Observer] = [
        ResultRecorder(job.folder, quantities, every),
        CsvRecorder(job.out / CSV, every),
    ]
    ledger = None
    if scenario.energy.ledger:
        system = counted(system, assembly.counting_instances(scenario, system))
        ledger = Ledger(system, every, job.folder)
        recorders = [*(Trimmed(recorder, system) for recorder in recorders), ledger]
    counter = _Counter()
    stage = job.reporter.stage(f"coupled run, master {scenario.master.name}", scenario.stop_time)
    with watching(scenario, job.out / SUMMARY, summary) as watchdog:
        participants = assembly.participants_of(scenario, system, fmus, watchdog.made)
        try:
            with stage as bar, Interruption() as interruption:
                keeper = [_checkpoints(job, identity, interruption)] if scenario.checkpoint_every else []
                statistics = simulate(
                    system,
                    participants,
                    scenario.made_master(),
                    scenario.made_steps(),
                    scenario.stop_time,
                    [*watchdog.observers, *recorders, counter, *keeper, bar, interruption],
                    resumed=job.resumed[1] if job.resumed else None,
                )
        finally:
            summary.macro_steps, summary.iterations = max(0, counter.steps), counter.iterations
            summary.coupled_time_s = counter.time_s
            summary.energy = ledger.account() if ledger else None
            for participant in participants.values():
                participant.close()
    summary.do_steps = statistics.do_steps
    summary.iterations = statistics.iterations
    summary.coupled_time_s = statistics.coupled_time_s


def _checkpoints(job: Job, identity: Identity, interruption: Interruption) -> Checkpoints:
    every, stop = job.scenario.checkpoint_every, job.scenario.stop_time
    path = job.folder / CHECKPOINT
    return Checkpoints(path, identity, every, stop, lambda: interruption.asked, job.reporter.line)


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

    def state(self) -> dict[str, Plain]:
        return {
            "steps": self.steps,
            "iterations": self.iterations,
            "time_s": clock.perf_counter() - self._began,
        }

    def resume(self, names: Sequence[str], state: Mapping[str, Plain]) -> None:
        self.steps, self.iterations = state["steps"], state["iterations"]
        self._began = clock.perf_counter() - state["time_s"]

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
