"""tribocosim study, calibrate, design and masters: many runs of a scenario."""

from dataclasses import asdict
from pathlib import Path
from typing import Annotated

import typer

from ..packages import check_fit_packages, check_study_packages
from .apart import carry_out_apart
from .completion import ScenarioName, complete_study
from .error_report import report_errors
from .json_output import Json, build_reporter, print_json
from .options import Overwrite, Restart, Settings, Workers, folder_option


@report_errors
def run_study(
    study: Annotated[
        str,
        typer.Argument(help="A shipped study, or the path of a .toml file.", autocompletion=complete_study),
    ],
    out: Annotated[
        Path | None, typer.Option(help="The zarr store.", show_default="results/STUDY.zarr")
    ] = None,
    scheduler: Annotated[
        str | None,
        typer.Option(metavar="ADDRESS", help="Use a running dask scheduler, e.g. tcp://host:8786."),
    ] = None,
    workers: Workers = None,
    timeout: Annotated[float, typer.Option(min=0.1, help="Time to wait for the scheduler (s).")] = 10.0,
    retry_failed: Annotated[bool, typer.Option("--retry-failed", help="Repeat failed points.")] = False,
    overwrite: Restart = False,
    as_json: Json = False,
) -> int:
    """Run a parameter study. The same command continues an interrupted study.

    Exit status 0: all points done, 1: some failed (their messages are in the store), 2: a mistake in the
    study or the command, 3: the workers cannot go on, 130: interrupted.
    """
    from orchestrator.errors import MistakeError, Option

    check_study_packages()
    from orchestrator.study.files import load
    from orchestrator.study.run import Where, run

    from ..cached_fmus import build_fmu

    if scheduler and workers:
        remedy = "leave it out with ", Option("scheduler")
        raise MistakeError((Option("workers"), ": are processes on this machine"), remedy)
    plan = load(study, build_fmu)
    store = out or Path("results") / f"{plan.study.name}.zarr"
    where, reporter = Where(scheduler, workers, timeout), build_reporter(as_json)
    status = run(plan, store, where, reporter, overwrite, retry_failed)
    if as_json:
        import xarray

        with xarray.open_zarr(store) as found:
            print_json(found.load().to_dict())
    return status


@report_errors
def run_calibrate(  # noqa: PLR0913  # options of the command
    scenario: ScenarioName,
    data: Annotated[
        list[Path], typer.Argument(help="CSV files of measured signals over angle or time, with speed.")
    ],
    parameters: Annotated[
        list[str] | None,
        typer.Option(metavar="COMPONENT.PARAMETER,...", help="Fit these; repeat, or separate by commas."),
    ] = None,
    signal: Annotated[
        list[str] | None,
        typer.Option(
            metavar="COLUMN=COMPONENT.OUTPUT,...",
            help="What a column was measured of; behind it offset, gain, noise VALUE.",
        ),
    ] = None,
    bounds: Annotated[
        list[str] | None,
        typer.Option(metavar="COMPONENT.PARAMETER=LOW..HIGH", help="Bounds of a parameter, with units."),
    ] = None,
    starts: Annotated[int, typer.Option(min=1, help="Fit from so many starts between the bounds.")] = 1,
    profile: Annotated[
        list[str] | None,
        typer.Option(metavar="PARAMETER,...", help="Intervals by profiles of the likelihood; or: all."),
    ] = None,
    out: Annotated[Path | None, folder_option("results/SCENARIO-calibration")] = None,
    set_: Settings = None,
    workers: Workers = None,
    overwrite: Restart = False,
    as_json: Json = False,
) -> int:
    """Fit parameters of a scenario to measured signals, with intervals, and say what they do not show.

    Signals over an angle, or with a speed, are of steady cycles; signals over time alone are of the
    scenario's run. The same command continues an interrupted one. Exit status 0: fitted, 1: a motion could
    not be computed, 2: a mistake in scenario, data or command, 130: interrupted.
    """
    check_fit_packages()
    from orchestrator.study.calibration.run import Asked, Source, calibrate
    from orchestrator.study.run import Where

    from ..cached_fmus import build_fmu
    from ..scenario import read_tables

    tables = read_tables(scenario, set_ or [])
    source = Source(tables, "" if set_ else scenario)
    asked = Asked(parameters or [], bounds or [], signal or [], starts, profile or [])
    folder = out or Path("results") / f"{tables['name']}-calibration"
    found = calibrate(
        source, data, asked, folder, Where(workers=workers), build_fmu, build_reporter(as_json), overwrite
    )
    if as_json:
        print_json(found.to_dict())
    return 0


@report_errors
def design_cam(
    brief: Annotated[
        str, typer.Argument(help="A scenario, whose own cam gives the limits, or the .toml file of a brief.")
    ],
    out: Annotated[Path | None, folder_option("results/BRIEF-design")] = None,
    set_: Settings = None,
    overwrite: Restart = False,
    as_json: Json = False,
) -> int:
    """Find the cam with the most lift area within limits on contacts, curvature, acceleration and separation.

    Writes a scenario with the cam's lift table. The same command continues an interrupted search. Exit status
    0: all limits are kept, 1: no such cam was found, or its coupled run fails or breaks a limit, 2: a mistake
    in the brief, 130: interrupted.
    """
    from orchestrator.reporter import tell_interruption
    from orchestrator.study.design.brief import read_brief
    from orchestrator.study.design.files import describe_kept
    from orchestrator.study.design.run import design

    from ..cached_fmus import build_fmu

    asked = read_brief(brief, set_ or [])
    folder = out or Path("results") / f"{Path(brief).stem}-design"
    with tell_interruption(lambda: describe_kept(folder)):
        found = design(asked, folder, build_fmu, build_reporter(as_json), overwrite)
    if as_json:
        print_json(found.to_dict())
    return 0 if found.attrs["feasible"] else 1


@report_errors
def run_masters(
    scenario: ScenarioName,
    set_: Settings = None,
    master: Annotated[
        list[str] | None, typer.Option(metavar="MODULE:OBJECT", help="Also run a master of your own.")
    ] = None,
    out: Annotated[Path | None, folder_option("results/SCENARIO-masters")] = None,
    overwrite: Overwrite = False,
    as_json: Json = False,
) -> None:
    """Run a scenario with every master that its FMUs can take: the error of each against its work."""
    check_study_packages()
    from orchestrator.reporter import tell_interruption
    from orchestrator.scenario.files import read
    from orchestrator.scenario.system import build_system
    from orchestrator.study.masters import compare_masters

    from ..cached_fmus import build_fmu
    from ..scenario import Scenario

    content = Scenario(*read(scenario, set_ or []))
    carry_out_apart(checked := content.check(), None)
    build_system(checked)  # a mistake in it would be each master's
    reporter = build_reporter(as_json)
    with tell_interruption():
        found = compare_masters(
            lambda changes: content.with_(changes).check(), master or [], out, overwrite, build_fmu, reporter
        )
    if as_json:
        print_json([asdict(one) for one in found])
