"""tribocosim sensitivities."""

from pathlib import Path
from typing import Annotated

import typer

from ..packages import check_study_packages
from .completion import ScenarioName
from .error_report import report_errors
from .json_output import Json, build_reporter, print_json
from .options import Settings, folder_option


@report_errors
def run_sensitivities(
    scenario: ScenarioName,
    speed: Annotated[
        str | None,
        typer.Option(metavar="SPEED", help="Speed of the flywheel.", show_default="the scenario's"),
    ] = None,
    parameter: Annotated[
        list[str] | None,
        typer.Option(
            metavar="COMPONENT.PARAMETER",
            help="Vary this parameter, or the speed; repeat for several.",
            show_default="speed and all continuous parameters but zeros and elements of arrays",
        ),
    ] = None,
    out: Annotated[Path | None, folder_option("results/SCENARIO-sensitivities")] = None,
    set_: Settings = None,
    as_json: Json = False,
) -> None:
    """Find which parameters move the figures of merit of a valve train's steady cycle, and by how much."""
    check_study_packages()
    from orchestrator.run.interruption import tell_interruption
    from orchestrator.scenario import build_scenario
    from orchestrator.store.output_folder import refuse_file
    from orchestrator.study.speeds.sensitivities import find_sensitivities, publish
    from orchestrator.study.speeds.sweep import parse_speed

    from ..scenario import read_tables

    tables = read_tables(scenario, set_ or [])
    checked = build_scenario(tables)
    folder = out or Path("results") / f"{checked.name}-sensitivities"
    refuse_file(folder)
    reporter = build_reporter(as_json)
    at = None if speed is None else parse_speed("speed", speed)
    with tell_interruption(lambda: "nothing is kept: the same command begins anew"):
        found = find_sensitivities(tables, at, parameter or [], reporter)
    publish(found, checked, folder, reporter)
    if as_json:
        print_json(found.to_dict())
