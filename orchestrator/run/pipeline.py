"""One run of a scenario: coupled, reference, comparison, files."""

from __future__ import annotations

import time as clock
from collections.abc import Iterator
from contextlib import contextmanager, nullcontext
from functools import partial
from importlib import metadata
from pathlib import Path

from models.core.system import ModelError

from ..assessment.assess import judge
from ..assessment.contacts import courses_of_rows, with_angles
from ..assessment.diagnosis import Facts, diagnosed, steps_of, suggestions
from ..assessment.summary import FAILED, INTERRUPTED, ROWS, Summary
from ..errors import CheckpointError, RefusedError, RunError
from ..scenario import Scenario, ScenarioError
from ..scenario.files import to_full_toml
from ..scenario.warnings import list_warnings
from ..store.atomic_write import NO_ROOM, naming, replace
from ..store.csv_file import write_csv, write_units
from ..store.journal import Recorded, journals
from ..store.result_file import ResultFile
from ..store.run_state import clear, shown
from . import assembly
from .checkpoint import NAME as CHECKPOINT
from .checkpoint import Identity
from .execute import run_coupled
from .job import Job
from .output_folder import CSV, FIGURES, RESULT, SCENARIO, SUMMARY, UNITS, files, prepared
from .report import Reporter
from .workload import announce


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
    summary. What it is to `overwrite` stays until its first values are recorded. Raises ScenarioError,
    ModelError or OutputFolderError before anything is written.
    """
    system = assembly.system_of(scenario)
    assembly.check_reference(scenario, system)
    out = out.absolute()  # an FMU may change the working directory
    with prepared(out, overwrite) as (folder, earlier):
        replace(out / SCENARIO, to_full_toml(scenario).encode())
        for line in list_warnings(scenario):
            reporter.line(line)
        if line := announce(scenario, system.outputs.size, out):
            reporter.line(line)
        try:
            summary = carry_out(
                Job(
                    scenario, system, out, folder, build, reporter, figures,
                    begun=earlier.drop, spared=lambda: earlier.held,
                )
            )  # fmt: skip
        except RefusedError as error:  # a mistake in the scenario or a given file
            kept = _kept(out) if earlier.held else ""
            clear(folder)
            for file in files(out):
                file.unlink()
            raise ScenarioError(f"{error}{kept}") from None
        if earlier.held:
            summary.message += _kept(out)
    return summary


def _kept(out: Path) -> str:
    """The end of a message about a run of which nothing was recorded."""
    return f"; the run did not begin, and what was in {shown(out)} before is kept"


def carry_out(job: Job) -> Summary:
    """Run from the start or the checkpoint to the end, and write everything.

    CheckpointError if the run cannot go on from the checkpoint, RefusedError if a participant fails before
    the first values; nothing that it needs is changed then.
    """
    began = clock.perf_counter()
    summary = begun(job.scenario)
    summary.figures = job.figures
    if not job.resumed:  # of a process that is ended from within, by whatever, it is what is left
        summary.write(job.out / SUMMARY)
    refused = False
    try:
        with _outcome(summary, job.out):
            _stages(job, summary)
    except (CheckpointError, RefusedError):
        refused = True
        raise
    finally:
        if not refused:
            summary.wall_time_s = job.spent + clock.perf_counter() - began
            summary.resumable &= (job.folder / CHECKPOINT).exists()
            if summary.message.endswith(NO_ROOM):
                summary.message += f"; {_remedy(job)}"
            told = _told(job, summary)
    if not told or job.spared():  # the summary of its beginning is left, and all that it needs to go on
        return summary
    if not summary.resumable and (job.out / RESULT).exists():
        clear(job.folder)
    job.reporter.end(summary, job.out, files(job.out))
    return summary


def _told(job: Job, summary: Summary) -> bool:
    """The summary is written; where there is no room for it, a run without another fault is not complete."""
    try:
        summary.write(job.out / SUMMARY)
    except OSError as error:
        if summary.complete:
            summary.complete, summary.exit_status = False, FAILED
            summary.message = f"incomplete: {error.filename}: {error.strerror}; {_remedy(job)}"
        return False
    return True


def _remedy(job: Job) -> str:
    """Where a disk is full."""
    if (job.folder / CHECKPOINT).exists():
        return f"free some space, then tribocosim resume {shown(job.out)} goes on from the last checkpoint"
    if (job.out / RESULT).exists():
        return "there is no checkpoint to go on from; free some space and run it anew with --overwrite"
    return f"free some space, then tribocosim resume {shown(job.out)} makes the result of what was recorded"


def begun(scenario: Scenario) -> Summary:
    """The summary of a run of which nothing is known yet."""
    return Summary(
        scenario=scenario.name,
        description=scenario.description,
        version=metadata.version("tribocosim"),
        master=scenario.master.model_dump(),
        macro_step=scenario.macro_step,
        fixed_steps=scenario.step_control is None,
        tolerance=dict(scenario.tolerance),
    )


def _stages(job: Job, summary: Summary) -> None:
    with job.reporter.stage("FMUs"):
        fmus = assembly.fmu_files(job.scenario, job.build)
    summary.fmus = {name: file.sha256 for name, file in fmus.items()}
    identity = Identity.of(job.out / SCENARIO, summary.fmus)
    if job.resumed:
        identity.check(job.resumed[0], shown(job.out))
    system, coupled = job.system, False
    with _outcome(summary, job.out):
        system = assembly.at_start(job.scenario, system)
        run_coupled(job, system, fmus, identity, summary)
        coupled = True
    if job.spared():
        return
    with written_result(job, summary) as result:
        if coupled:
            with _outcome(summary, job.out):
                judge(job.scenario, system, result, summary, job.reporter)


@contextmanager
def written_result(job: Job, summary: Summary) -> Iterator[ResultFile]:
    """The result of what has been recorded, finished after the block as the summary says, and drawn."""
    with ResultFile(job.out / RESULT, _attributes(job.scenario, summary)) as result:
        with job.reporter.stage("result file"), naming(job.out / RESULT):
            recorded = {name: Recorded(path) for name, path in journals(job.folder).items()}
            for name, journal in recorded.items():
                result.take(name, journal)
        if "coupled" in recorded:
            write_csv(job.out / CSV, recorded["coupled"])
            write_units(job.out / UNITS, recorded["coupled"])
        _diagnosed(job.scenario, result, summary)
        if result.length("coupled") > 1:
            read = partial(result.read, "coupled", rows=slice(None))
            if not summary.contacts and (found := courses_of_rows(job.system, read)):
                summary.contacts, summary.contacts_from = found, ROWS
            summary.contacts = with_angles(job.system, summary.contacts, read)
        yield result
        result.finish(summary.complete, summary.message)
        if job.figures and summary.exit_status != INTERRUPTED and result.length("coupled") > 1:
            from .. import plots

            name = job.scenario.name
            title = name if summary.complete else f"{name} (incomplete)"
            figures = plots.applying(result, title, job.scenario)
            with job.reporter.stage("figures") if figures else nullcontext():
                plots.draw(figures, job.out / FIGURES)
            if not figures:
                job.reporter.line("no figures: none is known for these components")


def _diagnosed(scenario: Scenario, result: ResultFile, summary: Summary) -> None:
    """What limited the steps, of an incomplete run too."""
    steps = steps_of(result)
    summary.steps = diagnosed(steps, summary.do_steps)
    if summary.steps:
        summary.rejected_steps = summary.steps.rejected
        summary.suggestions = suggestions(Facts(summary.steps, steps, scenario))


@contextmanager
def _outcome(summary: Summary, out: Path) -> Iterator[None]:
    """Put what ends a run early into the summary."""
    try:
        yield
    except (CheckpointError, RefusedError):
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
        "scenario_toml": to_full_toml(scenario),
        "versions": versions,
        "fmu_sha256": sums or "none",
    }
