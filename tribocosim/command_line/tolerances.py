"""tribocosim tolerances."""

from pathlib import Path
from typing import Annotated

import typer

from ..packages import check_study_packages
from .completion import ScenarioName
from .error_report import report_errors
from .json_output import Json, build_reporter, print_json
from .options import Restart, Settings, Workers, folder_option


@report_errors
def run_tolerances(
    scenario: ScenarioName,
    tolerances: Annotated[Path, typer.Argument(metavar="TOLERANCES.toml", help="Distributions and limits.")],
    out: Annotated[Path | None, folder_option("results/SCENARIO-tolerances")] = None,
    set_: Settings = None,
    workers: Workers = None,
    overwrite: Restart = False,
    as_json: Json = False,
) -> int:
    """Find what scatter of parameters and grinding errors do to a train: percentiles, yield, what costs most.

    The same command continues an interrupted one. Exit status 0: all trains were computed, 1: some failed,
    2: a mistake in the scenario, the file or the command, 130: interrupted.
    """
    check_study_packages()
    from orchestrator.study.run import Where
    from orchestrator.study.tolerances.report import publish
    from orchestrator.study.tolerances.run import find_tolerances, make_subject
    from orchestrator.study.tolerances.table import read_tolerances

    from ..scenario import read_tables

    tables, given = read_tables(scenario, set_ or []), read_tolerances(tolerances)
    _, limits = make_subject(tables, given)
    name = tables["name"]
    folder = out or Path("results") / f"{name}-tolerances"
    reporter = build_reporter(as_json)
    found = find_tolerances(tables, given, folder, Where(workers=workers), reporter, overwrite)
    publish(found, limits, f"{name} at {found.attrs['speed_rpm']:.0f} r/min", folder, reporter)
    if as_json:
        print_json(found.drop_vars("sample").to_dict())
    return int(found.attrs["status"])
