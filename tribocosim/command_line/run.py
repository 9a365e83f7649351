"""tribocosim run, tribocosim resume."""

from __future__ import annotations

import time as clock
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from ..messages import say
from .apart import carry_out_apart
from .completion import ScenarioName
from .error_report import INTERRUPTED, report_errors
from .json_output import Json, build_reporter, print_json
from .options import Settings, folder_option

if TYPE_CHECKING:
    from models.core.remedies import Words
    from orchestrator.run.summary import Summary


NoFigures = Annotated[bool, typer.Option("--no-figures", help="Draw no figures and write no report.")]
Verbose = Annotated[
    bool, typer.Option("--verbose", help="Print all errors, the effort, and the output of FMUs.")
]


@report_errors
def run_scenario(  # noqa: PLR0913  # options of a command
    scenario: ScenarioName,
    out: Annotated[Path | None, folder_option("results/SCENARIO")] = None,
    set_: Settings = None,
    native: Annotated[
        bool, typer.Option("--native", help="Use native FMUs wherever the scenario builds FMUs.")
    ] = False,
    master: Annotated[
        str | None, typer.Option(help="Use another master; auto chooses one, with its signals and steps.")
    ] = None,
    witness: Annotated[
        str | None, typer.Option(help="multibody: also solve the train as bodies with joints, and compare.")
    ] = None,
    overwrite: Annotated[
        bool,
        typer.Option(
            "--overwrite", help="Replace a result in the folder once the new run has its first values."
        ),
    ] = False,
    no_figures: NoFigures = False,
    verbose: Verbose = False,
    as_json: Json = False,
) -> int:
    """Run a scenario and compare it with the reference.

    Exit status 0: within the tolerance, or without a reference, 1: outside the tolerance, 2: a mistake in the
    scenario or the command, 3: the run failed, 4: the reference could not be computed, 130: interrupted.
    """
    from orchestrator.scenario.files import load

    overrides = [f"master.name={master}"] if master else []
    overrides += [f"reference.witness={witness}"] if witness else []
    overrides += set_ or []
    loaded = load(scenario, overrides)
    if native:
        loaded = loaded.with_native_fmus()
    from orchestrator.run.pipeline import run_plan  # a scenario's mistake is told before
    from orchestrator.store.output_folder import check_folder

    from ..planning import resolve_run

    folder = out or Path("results") / loaded.name
    carry_out_apart(loaded, folder)
    began, reporter = clock.perf_counter(), build_reporter(as_json, verbose)
    check_folder(folder, overwrite)
    plan = resolve_run(loaded, reporter, figures=not no_figures)
    summary = run_plan(plan, folder, reporter, overwrite, began)
    return _finish(summary, folder, as_json)


@report_errors
def resume_run(
    folder: Annotated[Path, typer.Argument(help="Output folder of the run.")],
    keep: Annotated[
        bool, typer.Option("--keep", help="Do not go on: make the result of what was recorded.")
    ] = False,
    no_figures: NoFigures = False,
    verbose: Verbose = False,
    as_json: Json = False,
) -> int:
    """Continue a killed or interrupted run from its last checkpoint, with the same results.

    Exit status as for `run`; 2 also if the run cannot be continued (another FMU, version or scenario, or a
    damaged checkpoint).
    """
    from orchestrator.run.pipeline import resume
    from orchestrator.scenario.files import load
    from orchestrator.store.output_folder import SCENARIO

    from ..cached_fmus import build_fmu

    if (folder / SCENARIO).is_file():
        carry_out_apart(load(folder / SCENARIO), folder)
    reporter = build_reporter(as_json, verbose)
    summary = resume(folder, build_fmu, reporter, figures=not no_figures, keep=keep)
    return _finish(summary, folder, as_json)


def _finish(summary: Summary, folder: Path, as_json: bool) -> int:
    """Print the summary if it is asked for; report why a run is incomplete and how to continue it.

    Returns the exit status.
    """
    from models.core.remedies import Command, Option, find_actions, in_command_line
    from orchestrator.store.output_folder import REPORT

    if as_json:
        print_json(summary.content())
    if not summary.complete:
        remedy: Words = ""
        if summary.resumable and not find_actions(summary.message):
            remedy = "; ", Command("resume", (folder,)), " continues this run"
            if summary.exit_status == INTERRUPTED and not summary.whole and (folder / REPORT).exists():
                remedy = *remedy, ", ", Command("report", (folder,)), " draws what is there"
        elif summary.exit_status == INTERRUPTED:
            remedy = "; it has no checkpoint: repeat the command with ", Option("overwrite", True)
        say(in_command_line((summary.message, remedy)))
    return summary.exit_status
