"""One run of a scenario: plan, execute, assess, publish."""

import time as clock
from contextlib import AbstractContextManager, nullcontext
from dataclasses import replace
from pathlib import Path

from ..errors import RefusedError, join
from ..reporter import Reporter
from ..scenario import Scenario, ScenarioError
from ..scenario.system import Builder
from ..store import atomic_write
from ..store.output_folder import PRINTED, SCENARIO, OutputFolder, check_folder, format_path, open_folder
from .assess import assess
from .execute import execute
from .plan import Plan, make_plan
from .publish import finish_result, open_result, publish, publish_merits, settle_ending
from .record import ENDS, Record, classify_ending
from .summary import Summary, summarise
from .workload import announce


def run(
    scenario: Scenario,
    out: Path,
    build: Builder,
    reporter: Reporter,
    overwrite: bool = False,
    figures: bool = True,
) -> Summary:
    """Plan a run and make it, as `run_plan` does; ModelError or ScenarioError before anything is written."""
    check_folder(out, overwrite)
    began = clock.perf_counter()
    return run_plan(make_plan(scenario, build, reporter, figures), out, reporter, overwrite, began)


def run_plan(
    plan: Plan, out: Path, reporter: Reporter, overwrite: bool = False, began: float | None = None
) -> Summary:
    """Run and write everything into `out`. The summary's `exit_status` is 0 only within the tolerance.

    A run that fails or is interrupted leaves what was recorded, marked incomplete; its message is in the
    summary. What `overwrite` replaces stays until the first values are recorded. The wall time counts from
    `began` of `perf_counter`. Raises OutputFolderError before anything is written.
    """
    start = clock.perf_counter() if began is None else began
    out = out.absolute()  # an FMU may change the working directory
    check_folder(out, overwrite)
    with open_folder(out, overwrite) as folder, keep_prints(plan, folder, reporter):
        atomic_write.replace(out / SCENARIO, plan.toml.encode())
        if line := announce(plan.scenario, plan.system.outputs.size, out):
            reporter.line(line)
        try:
            record = execute(plan, folder, reporter)
        except RefusedError as error:  # a mistake in the scenario or a given file
            kept = _tell_of_backup(folder)
            folder.discard()
            raise ScenarioError((error, kept)) from None
        if folder.backup.exists:
            message = join(record.ending.message, _tell_of_backup(folder))
            return summarise(plan, replace(record.ending, message=message, resumable=False), record)
        return conclude(plan, record, folder, reporter, start)


def conclude(plan: Plan, record: Record, folder: OutputFolder, reporter: Reporter, start: float) -> Summary:
    """Assess what was recorded and publish it. The run began at `start` of `perf_counter`."""
    assessment, ending = None, record.ending
    try:
        with open_result(plan, folder, reporter) as result:
            assessment = assess(plan, record, result, reporter)
            ending = assessment.ending
            publish_merits(plan, assessment, result)
            finish_result(plan, ending, result, reporter)
    except ENDS as error:
        failure = classify_ending(error, folder.path)
        ending = replace(failure, resumable=failure.resumable and ending.resumable)
    seconds = clock.perf_counter() - start
    summary = summarise(plan, settle_ending(ending, folder), record, assessment, seconds)
    return publish(summary, folder, reporter)


def keep_prints(plan: Plan, folder: OutputFolder, reporter: Reporter) -> AbstractContextManager[None]:
    """For the block in which the FMUs of the plan run; ours print nothing."""
    return reporter.keep_prints(folder.path / PRINTED) if plan.third_party else nullcontext()


def _tell_of_backup(folder: OutputFolder) -> str:
    """The end of a message about a run that had no first values."""
    if not folder.backup.exists:
        return ""
    return f"; the run did not begin, and what was in {format_path(folder.path)} before is kept"
