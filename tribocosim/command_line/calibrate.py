"""tribocosim calibrate."""

from pathlib import Path
from typing import Annotated

import typer

from ..packages import check_fit_packages
from .completion import ScenarioName
from .error_report import report_errors
from .json_output import Json, build_reporter, print_json
from .options import Settings, Workers, folder_option


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
    overwrite: Annotated[bool, typer.Option("--overwrite", help="Replace the results.")] = False,
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
