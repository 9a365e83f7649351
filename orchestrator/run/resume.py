"""Going on with a run that was killed or interrupted."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

from ..assessment.summary import FAILED, Summary
from ..errors import RefusedError
from ..scenario.files import load
from ..store.backup import Earlier
from ..store.journal import Recorded, journals
from ..store.run_state import clear, locked, shown, unfinished
from . import assembly
from .checkpoint import NAME as CHECKPOINT
from .checkpoint import read
from .job import Job
from .output_folder import SCENARIO, SUMMARY, OutputFolderError, files, meant
from .pipeline import begun, carry_out, written_result
from .report import Reporter


def resume(out: Path, build: assembly.Builder, reporter: Reporter, figures: bool = True) -> Summary:
    """Go on with the run in `out` from its last checkpoint; it ends as it would have without the stop.

    `figures` are drawn unless the run was begun without. A run that was stopped before it had computed
    anything begins anew. Of one without checkpoints the result is made of what was recorded, marked
    incomplete. Raises CheckpointError or another MistakeError where the run cannot go on; nothing that it
    needs is changed then.
    """
    if not (out / SCENARIO).is_file():
        remedy = "tribocosim run makes one"
        if (out / SUMMARY).exists() or unfinished(out).exists():
            remedy = "put back the file that the run had written"
        elif folder := meant(out):
            remedy = f"did you mean {folder}?"
        raise OutputFolderError(f"{out}: holds no run (there is no {SCENARIO}); {remedy}")
    if not unfinished(out).exists():
        return _ended(out, reporter)
    out = out.absolute()  # an FMU may change the working directory
    with locked(out) as folder:
        before = _summary(out)
        if before.get("complete"):  # killed while it tidied up
            clear(folder)
            return _ended(out, reporter)
        scenario = load(out / SCENARIO)
        system = assembly.system_of(scenario)
        figures = figures and before.get("figures", True)
        job = Job(scenario, system, out, folder, build, reporter, figures, begun=Earlier(out).drop)
        if (folder / CHECKPOINT).exists():
            identity, state = read(folder / CHECKPOINT)
            # A killed process has left no wall time, but that of its steps.
            spent = max(before.get("wall_time_s", 0.0), state["elapsed"])
            job = replace(job, resumed=(identity, state), spent=spent)
        elif _rows(folder, "coupled") > 1:
            return _kept(job)
        else:
            clear(folder)
        try:
            return carry_out(job)
        except RefusedError as error:
            raise OutputFolderError(f"{shown(out)}: {error}") from None


def _ended(out: Path, reporter: Reporter) -> Summary:
    """The summary of a run that came to its end."""
    found = _summary(out)
    if found.get("exit_status") == FAILED:
        why = found["message"].removeprefix("incomplete: ")
        raise OutputFolderError(
            f"{shown(out)}: the run failed, and would fail again: {why}; change the scenario and run it "
            f"anew, with --out {shown(out)} --overwrite"
        )
    if not found.get("complete"):
        raise OutputFolderError(
            f"{shown(out)}: the run left nothing to go on from; repeat it with tribocosim run "
            f"{shown(out) / SCENARIO} --out {shown(out)} --overwrite"
        )
    reporter.line(f"{shown(out)}: the run is complete; there is nothing to continue")
    known = ("scenario", "description", "version", "master", "macro_step", "fixed_steps", "tolerance")
    told = ("complete", "resumable", "message", "verdict", "exit_status", "macro_steps", "iterations")
    return Summary(**{key: found[key] for key in (*known, *told)})


def _summary(out: Path) -> dict[str, Any]:
    try:
        found: dict[str, Any] = json.loads((out / SUMMARY).read_text("utf-8"))
        return found
    except (OSError, ValueError):
        return {}


def _rows(folder: Path, name: str) -> int:
    found = journals(folder)
    return Recorded(found[name]).rows if name in found else 0


def _kept(job: Job) -> Summary:
    """The result of what a run without checkpoints has recorded."""
    summary = begun(job.scenario)
    summary.resumable, summary.figures = False, job.figures
    summary.message = (
        "incomplete: the run was stopped and has left no checkpoint (checkpoint_every = 0, or "
        "an FMU that cannot be serialised); the result is what it had recorded"
    )
    if names := [
        name for name, table in job.scenario.components.items() if table.untrusted and not table.own_process
    ]:
        summary.message += (
            f"; if one of its FMUs ended it ({', '.join(names)}), components.{names[0]}.process = 'own' says "
            "which and where"
        )
    until = {name: Recorded(path).last_time() for name, path in journals(job.folder).items()}
    if len(set(until.values())) > 1:
        said = (f"/{name} {'nothing' if t is None else f'until {t:g} s'}" for name, t in until.items())
        summary.message += f"; of {', '.join(said)}"
    # On a full disk only one may have been written any more.
    records, every = _rows(job.folder, "coupled") - 1, job.scenario.record_every
    at_least = records * every
    if until["coupled"] == job.scenario.stop_time:  # recorded wherever it falls
        at_least -= every - 1
    summary.macro_steps = max(_rows(job.folder, "steps"), at_least)
    with written_result(job, summary):
        pass
    summary.write(job.out / SUMMARY)
    clear(job.folder)
    job.reporter.end(summary, job.out, files(job.out))
    return summary
