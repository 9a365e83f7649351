"""tribocosim wear."""

from pathlib import Path
from typing import Annotated

import typer

from ..packages import check_study_packages
from .completion import ScenarioName
from .error_report import report_errors
from .json_output import Json, build_reporter, print_json
from .options import Overwrite, Settings, folder_option


@report_errors
def run_wear(  # noqa: PLR0913  # options of a command
    scenario: ScenarioName,
    until: Annotated[str, typer.Option(metavar="DEPTH", help="Depth of the cam's wear.")] = "0.127 mm",
    wear_coefficient: Annotated[
        str,
        typer.Option(
            metavar="LEAST,LARGEST",
            help="Wear volume over load times sliding distance, in m2/N; or one number.",
        ),
    ] = "1e-18,1e-16",
    speed: Annotated[
        str | None, typer.Option(help="Speed of the flywheel.", show_default="the scenario's")
    ] = None,
    contact: Annotated[
        str | None, typer.Option(help="Contact that wears.", show_default="the only one on a cam")
    ] = None,
    tolerance: Annotated[
        float,
        typer.Option(
            help="Error by extrapolation, as a part of the depth; the shortest steps may exceed it."
        ),
    ] = 0.01,
    wear_follower: Annotated[
        bool,
        typer.Option(
            "--wear-follower",
            help="The follower, which does not turn, wears too; until the depth of the first of both.",
        ),
    ] = False,
    set_: Settings = None,
    out: Annotated[Path | None, folder_option("results/SCENARIO-wear")] = None,
    overwrite: Overwrite = False,
    as_json: Json = False,
) -> int:
    """Find after how many cycles a valve train's cam has worn to a depth, by Archard's law.

    The worn cam goes back into the steady cycle. The same command continues after an interruption. Exit
    status 0: the depth is reached, 1: it is not, 2: a mistake in the scenario or the command, 130:
    interrupted.
    """
    check_study_packages()
    from orchestrator.study.wear.run import parse_asked, wear

    from ..scenario import read_tables

    asked = parse_asked(until, wear_coefficient, tolerance, contact, speed, wear_follower)
    tables = read_tables(scenario, set_ or [])
    folder = out or Path("results") / f"{tables['name']}-wear"
    found = wear(tables, asked, folder, build_reporter(as_json), overwrite)
    if as_json:
        print_json({**found.attrs, "table": found.to_dict()})
    return int(bool(found.attrs["fault"]))
