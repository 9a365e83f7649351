"""One run of a scenario: plan, execute, assess, publish."""

import time as clock
from contextlib import AbstractContextManager, nullcontext
from dataclasses import replace
from pathlib import Path
from typing import Any

from ..errors import Command, RefusedError, Words, in_command_line, join, start_over
from ..reporter import Reporter
from ..scenario import Scenario, ScenarioError
from ..scenario.files import load
from ..scenario.system import Builder, resolve
from ..store import atomic_write
from ..store.journal import Recorded, journals
from ..store.output_folder import (
    PRINTED,
    RESULT,
    SCENARIO,
    SUMMARY,
    Backup,
    OutputFolder,
    OutputFolderError,
    check_folder,
    clear_run_state,
    find_run_state,
    format_path,
    lock_folder,
    open_folder,
    refuse_missing,
    refuse_overwriting_source,
    suggest_folder,
)
from ..texts import parse_json, read_text
from .assess import assess
from .checkpoint import read
from .discards import execute_with_retries
from .plan import Plan, make_plan
from .publish import open_result, publish, publish_merits, settle_ending
from .summary import ENDS, FAILED, INTERRUPTED, Summary, begin_summary


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
    reporter.times.clear()
    plan = make_plan(resolve(scenario), build, reporter, figures)
    return run_plan(plan, out, reporter, overwrite, began)


def run_part(scenario: Scenario, out: Path, build: Builder, reporter: Reporter) -> Summary:
    """A run without figures, as a part of a command, which ends where the run is interrupted."""
    summary = run(scenario, out, build, reporter, figures=False)
    if summary.exit_status == INTERRUPTED:
        raise KeyboardInterrupt
    return summary


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
    if plan.scenario.origin:
        refuse_overwriting_source(plan.scenario.origin.path, plan.toml, out)
    with open_folder(out, overwrite) as folder, keep_prints(plan, folder, reporter):
        atomic_write.write_whole(out / SCENARIO, plan.toml.encode())
        try:
            plan, summary = execute_with_retries(plan, folder, reporter)
        except RefusedError as error:  # a mistake in the scenario or a given file
            kept = _tell_of_backup(folder)
            folder.discard()
            raise ScenarioError((error, kept)) from None
        if folder.backup.exists:
            message = join(summary.message, _tell_of_backup(folder))
            return replace(summary, message=message, resumable=False)
        return conclude(plan, summary, folder, reporter, start)


def conclude(plan: Plan, summary: Summary, folder: OutputFolder, reporter: Reporter, start: float) -> Summary:
    """Assess what was recorded and publish it. The run began at `start` of `perf_counter`."""
    try:
        with open_result(plan, folder, reporter) as result:
            summary = assess(plan, summary, result, reporter)
            publish_merits(plan, summary, result)
            result.finish(summary.complete, in_command_line(summary.message))
    except ENDS as error:
        summary = summary.end_by(error, folder.path)
    seconds, times = clock.perf_counter() - start, dict(reporter.times)
    ended = replace(settle_ending(summary, folder), wall_time_s=seconds, times=times)
    return publish(ended, folder, reporter)


def keep_prints(plan: Plan, folder: OutputFolder, reporter: Reporter) -> AbstractContextManager[None]:
    """For the block in which the FMUs of the plan run; ours print nothing."""
    return reporter.keep_prints(folder.path / PRINTED) if plan.third_party else nullcontext()


def _tell_of_backup(folder: OutputFolder) -> str:
    """The end of a message about a run that had no first values."""
    if not folder.backup.exists:
        return ""
    return f"; the run did not begin, and what was in {format_path(folder.path)} before is kept"


def resume(
    out: Path, build: Builder, reporter: Reporter, figures: bool = True, keep: bool = False
) -> Summary:
    """Continue the run in `out` from its last checkpoint; it ends as it would have without the stop.

    `figures` are drawn unless the run was started without. A run that was stopped before it had computed
    anything starts anew. With `keep`, or if there is no checkpoint, the result is made of what was recorded,
    and marked incomplete. Raises CheckpointError or another MistakeError where the run cannot continue;
    nothing that it needs is changed then.
    """
    start = clock.perf_counter()
    refuse_missing(out)
    if not (out / SCENARIO).is_file():
        remedy: Words = ("make one with ", Command("run"))
        if (out / SUMMARY).exists() or find_run_state(out).exists():
            remedy = "put back the file that the run had written"
        elif close := suggest_folder(out):
            remedy = f"did you mean {close}?"
        raise OutputFolderError(f"{out}: holds no run (there is no {SCENARIO})", remedy)
    if not find_run_state(out).exists():
        return _report_ended(out, reporter)
    out = out.absolute()  # an FMU may change the working directory
    with lock_folder(out) as pending:
        before = _read_summary(out)
        if before.get("complete"):  # killed while it tidied up
            clear_run_state(pending)
            return _report_ended(out, reporter)
        resolved = resolve(load(out / SCENARIO))
        plan = make_plan(resolved, build, reporter, figures and before.get("figures", True))
        folder = OutputFolder(out, pending, Backup(out))
        checkpoint = None
        recorded = _count_rows(pending, "coupled") > 1
        if keep and not recorded:
            raise OutputFolderError(f"{format_path(out)}: the run has recorded nothing; leave out --keep")
        if folder.checkpoint.exists() and not keep:
            checkpoint = read(folder.checkpoint)
            # A killed process has left no wall time, but that of its steps.
            start -= max(before.get("wall_time_s", 0.0), checkpoint[1]["elapsed"])
        elif recorded:
            return conclude(plan, _recover(plan, pending, keep), folder, reporter, start)
        else:
            clear_run_state(pending)
        with keep_prints(plan, folder, reporter):
            try:
                plan, summary = execute_with_retries(plan, folder, reporter, checkpoint)
            except RefusedError as error:
                raise OutputFolderError((f"{format_path(out)}: ", error)) from None
            return conclude(plan, summary, folder, reporter, start)


def _report_ended(out: Path, reporter: Reporter) -> Summary:
    """The summary of a run that came to its end."""
    found = _read_summary(out)
    if found.get("exit_status") == FAILED:
        why = found["message"].removeprefix("incomplete: ")
        raise OutputFolderError(
            f"{format_path(out)}: the run failed, and would fail again: {why}",
            ("change the scenario and ", start_over(format_path(out))),
        )
    if not found.get("complete"):
        raise OutputFolderError(
            f"{format_path(out)}: the run left nothing to go on from", start_over(format_path(out))
        )
    if not (out / RESULT).exists():
        gone = f"{format_path(out)}: the run is complete, but {RESULT} is not there"
        raise OutputFolderError(gone, start_over(format_path(out)))
    reporter.line(f"{format_path(out)}: the run is complete; there is nothing to continue")
    known = ("scenario", "description", "version", "master", "macro_step", "fixed_steps", "tolerance")
    state = ("complete", "resumable", "message", "verdict", "exit_status", "macro_steps", "iterations")
    return Summary(**{key: found[key] for key in (*known, *state)})


def _read_summary(out: Path) -> dict[str, Any]:
    try:
        found: dict[str, Any] = parse_json(read_text(out / SUMMARY))
        return found
    except (OSError, ValueError):
        return {}


def _count_rows(folder: Path, name: str) -> int:
    found = journals(folder)
    return Recorded(found[name]).rows if name in found else 0


def _recover(plan: Plan, pending: Path, keep: bool) -> Summary:
    """The summary of a run that is not continued from a checkpoint: because it left none, or with `keep`."""
    why = " and has left no checkpoint (checkpoint_every = 0, or an FMU that cannot be serialised)"
    message = f"incomplete: the run was stopped{'' if keep else why}; the result is what it had recorded"
    if names := plan.scenario.exposed:
        message += (
            f"; if one of its FMUs ended it ({', '.join(names)}), components.{names[0]}.process = 'own' says "
            "which and where"
        )
    until = {name: Recorded(path).last_time() for name, path in journals(pending).items()}
    if len(set(until.values())) > 1:
        ends = (f"/{name} {'nothing' if t is None else f'until {t:g} s'}" for name, t in until.items())
        message += f"; of {', '.join(ends)}"
    # On a full disk one journal may have fewer rows than the other.
    records, every = _count_rows(pending, "coupled") - 1, plan.scenario.record_every
    at_least = records * every
    if until["coupled"] == plan.scenario.stop_time:  # recorded wherever it falls
        at_least -= every - 1
    steps = max(_count_rows(pending, "steps"), at_least)
    return replace(begin_summary(plan), resumable=False, message=message, macro_steps=steps)
