"""Publish a run: its result file, tables, figures and summary, and what is printed at its end."""

import math
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import replace
from functools import cache
from importlib import metadata
from pathlib import Path

from rich.table import Table
from rich.text import Text

from models.core.words import tally

from ..assessment.merits import write_merits
from ..assessment.trains import find_angles
from ..errors import Command, Words, in_command_line, join, start_over
from ..reporter import DRAWING, PAGE, RECORDS, Reporter, make_table, tell_interruption
from ..scenario.values import WARNING
from ..store.atomic_write import NO_ROOM, naming
from ..store.csv_file import write_csv
from ..store.journal import Recorded, journals
from ..store.output_folder import (
    CSV,
    MERITS,
    REPORT,
    RESULT,
    SUMMARY,
    UNITS,
    OutputFolder,
    clear_run_state,
    format_path,
    list_files,
)
from ..store.result_file import ResultFile
from .comparison import Errors, VariableError, WitnessComparison
from .plan import Plan
from .summary import FAILED, INTERRUPTED, Summary

# Letters in a printed line, from which on its facts go on in another one.
WIDE = 110
PACKAGES = ("tribocosim", "numpy", "scipy", "numba", "scikit-sundae", "fmpy", "pythonfmu")


@contextmanager
def open_result(plan: Plan, folder: OutputFolder, reporter: Reporter) -> Iterator[ResultFile]:
    """The result file of what the journals hold, and the CSV files beside it."""
    angles = {name: angle.coordinate for name, angle in find_angles(plan.system).items()}
    with ResultFile(folder.path / RESULT, _describe(plan), angles) as result:
        with reporter.stage(RECORDS):
            with naming(folder.path / RESULT):
                recorded = {name: Recorded(path) for name, path in journals(folder.unfinished).items()}
                for name, journal in recorded.items():
                    result.take(name, journal)
            if "coupled" in recorded:
                write_csv(folder.path / CSV, folder.path / UNITS, recorded["coupled"], angles)
        yield result


def _describe(plan: Plan) -> dict[str, str]:
    """The attributes of the result file."""
    return {
        "title": plan.scenario.description or plan.scenario.name,
        "scenario": plan.scenario.name,
        "scenario_toml": plan.toml,
        "versions": ", ".join(f"{name} {metadata.version(name)}" for name in PACKAGES),
        "fmu_sha256": "\n".join(f"{name} {sha256}" for name, sha256 in plan.sha256.items()) or "none",
    }


def publish_merits(plan: Plan, summary: Summary, result: ResultFile) -> None:
    """The table of the figures of merit of what was recorded."""
    if result.length("coupled") > 1:
        path = result.path.with_name(MERITS)
        doubts = [] if summary.whole else [in_command_line(summary.message)]
        doubts += list_warnings(summary)
        write_merits(plan.system, summary.figures_of_merit, doubts, cache(result.column), path)


def list_warnings(summary: Summary) -> list[str]:
    """What is doubted of the scenario and of what its trains did."""
    said = (*summary.notices, *summary.merits)
    return [note for note in said if isinstance(note, str) and note.startswith(WARNING)]


def settle_ending(summary: Summary, folder: OutputFolder) -> Summary:
    """With the remedy for a full disk; resumable only from a checkpoint."""
    message = summary.message
    if in_command_line(message).endswith(NO_ROOM):
        message = join(message, "; ", _advise_on_full_disk(folder))
    return replace(summary, message=message, resumable=summary.resumable and folder.checkpoint.exists())


def _advise_on_full_disk(folder: OutputFolder) -> Words:
    out = format_path(folder.path)
    resume = "free some space, then ", Command("resume", (out,))
    if folder.checkpoint.exists():
        return *resume, " goes on from the last checkpoint"
    if (folder.path / RESULT).exists():
        return "there is no checkpoint to go on from; free some space and ", start_over(out)
    return *resume, " makes the result of what was recorded"


def publish(summary: Summary, folder: OutputFolder, reporter: Reporter) -> Summary:
    """Write the summary, remove what only an unfinished run needs, draw, and print the end of the run. The
    summary is written again with the time of drawing.

    Where the summary cannot be written, the one from the start of the run stays, and a complete run is
    returned as failed. KeyboardInterrupt while it draws says how to draw what is left.
    """
    try:
        summary.write(folder.path / SUMMARY)
    except OSError as error:
        if not summary.complete:
            return summary
        message = join(f"incomplete: {error.filename}: {error.strerror}; ", _advise_on_full_disk(folder))
        return replace(summary, complete=False, exit_status=FAILED, message=message)
    if not summary.resumable and (folder.path / RESULT).exists():
        clear_run_state(folder.unfinished)
    try:
        if summary.figures and (folder.path / RESULT).exists():
            _draw(folder.path, summary.whole or summary.exit_status != INTERRUPTED, reporter)
            drawn = summary.wall_time_s + sum(reporter.times.values()) - sum(summary.times.values())
            summary = replace(summary, wall_time_s=drawn, times=dict(reporter.times))
            with suppress(OSError):  # the one without is there
                summary.write(folder.path / SUMMARY)
    finally:
        _print_end(summary, folder.path, list_files(folder.path), reporter)
    return summary


def _draw(folder: Path, figures: bool, reporter: Reporter) -> None:
    from ..report import draw_pictures  # its libraries take long to import

    again = in_command_line(Command("report", (format_path(folder),)))
    with (
        tell_interruption(lambda: f"all numbers are written, {again} draws figures and report"),
        reporter.stage(DRAWING if figures else PAGE),
    ):
        told = draw_pictures(folder, figures)
    for line in told:
        reporter.line(line)


def _print_end(summary: Summary, out: Path, written_files: Sequence[Path], reporter: Reporter) -> None:
    """How far it came, the engineering result, verdict and largest error, and where the report is; why it is
    incomplete is for the caller to say."""
    told = list(summary.tell())
    if not summary.complete:
        reached = f", to t = {summary.steps.end:.6g} s" if summary.steps else ""
        reporter.line(f"incomplete: the run made {tally(summary.macro_steps, 'macro step')}{reached}")
        if told and not summary.whole:
            reporter.line("what follows is of a run that broke off, up to there:")
    for line in told:
        for part in fold(line):
            reporter.line(part)
    if summary.witness:
        reporter.console.print(_tabulate_witness(summary.witness))
    if reporter.verbose:
        _print_details(summary, out, written_files, reporter)
    if not summary.complete:
        return
    for line in ((f"{summary.scenario}: ", summary.verdict), summary.largest_error):
        if line:
            reporter.line(line)
    if doubts := list_warnings(summary):
        places = dict.fromkeys(doubt.removeprefix(WARNING).partition(": ")[0] for doubt in doubts)
        reporter.line(f"{WARNING}{', '.join(places)}: doubted as said above, see summary.csv")
    report = out / REPORT
    place = f"report in {format_path(report)}" if report.exists() else f"results in {format_path(out)}"
    reporter.line(f"{place}, after {summary.wall_time_s:.1f} s")


def fold(words: Words) -> Iterator[str]:
    """Facts between semicolons, as many in a line as have room; further lines are indented."""
    line, *groups = in_command_line(words).split("; ")
    for group in groups:
        if len(line) + len(group) > WIDE:
            yield f"{line};"
            line = f"  {group}"
        else:
            line += f"; {group}"
    yield line


def _print_details(summary: Summary, out: Path, written_files: Sequence[Path], reporter: Reporter) -> None:
    """What few need: all errors, effort, files."""
    if summary.python_sweeps:
        reasons = ", ".join(f"{name} ({why})" for name, why in summary.python_sweeps.items())
        reporter.line(f"macro steps in Python, not in compiled code, for {reasons}")
    if summary.errors:
        reporter.console.print(_tabulate(summary.errors, summary.reference_method))
    if summary.coupled_time_s:
        speed = summary.macro_steps / summary.coupled_time_s
        reference = summary.reference_time_s
        reporter.line(
            f"{tally(summary.macro_steps, 'macro step')}, {tally(summary.iterations, 'iteration')} in "
            f"{summary.coupled_time_s:.2f} s ({speed:.0f} steps/s)"
            + ("" if reference is None else f"; reference {reference:.2f} s")
        )
    names = ", ".join(str(file.relative_to(out)) for file in written_files)
    reporter.line(f"results in {format_path(out)}: {names}")


REFERENCES = {"monolithic": "the monolithic reference", "refinement": "the limit of runs with smaller steps"}


def _tabulate(errors: Errors, method: str) -> Table:
    """The comparison as a table; variables with a tolerance first."""
    refined = method == "refinement"
    starred = any(error.below_uncertainty for error in errors.values())
    table = make_table(
        f"Coupled run against {REFERENCES[method]} (SI units)",
        ["variable"],
        ["max", "RMS", "relative\nRMS", "reference\n±", *["order"] * refined, "allowed"],
        "* below the reference's own uncertainty" if starred else "",
    )
    table.add_column("")
    for name, error in sorted(errors.items(), key=lambda item: item[1].tolerance is None):
        table.add_row(
            Text(name),
            f"{error.max_abs:.1e}",
            f"{error.rms:.1e}",
            f"{error.relative_rms:.1e}{'*' if error.below_uncertainty else ''}",
            f"{error.uncertainty.relative_rms:.0e}",
            *[f"{error.order:.2f}" if math.isfinite(error.order or math.nan) else "none"] * refined,
            "" if error.tolerance is None else f"{error.tolerance:.0e}",
            _mark(error),
        )
    return table


def _tabulate_witness(witness: WitnessComparison) -> Table:
    """Coupled run, reference and witness side by side."""
    table = make_table(
        "Coupled run, monolithic reference and multibody model (SI units: least, largest)",
        ["quantity"],
        ["coupled", "reference", "multibody", "coupled,\nrelative RMS", "reference,\nrelative RMS"],
        f"{witness.method}\n{tally(witness.constraints, 'constraint')}, "
        f"{tally(witness.freedoms, 'freedom')}, constraints kept to {witness.drift:.0e}; "
        f"{witness.wall_time_s:.1f} s",
    )
    for name, row in witness.quantities.items():
        spans = (f"{low:.6g}\n{high:.6g}" for low, high in (row.coupled, row.reference, row.multibody))
        table.add_row(Text(name), *spans, f"{row.coupled_difference:.1e}", f"{row.reference_difference:.1e}")
    return table


def _mark(error: VariableError) -> Text:
    if error.tolerance is None:
        return Text("")
    return Text("within", "green") if error.within else Text("OUTSIDE", "bold red")
