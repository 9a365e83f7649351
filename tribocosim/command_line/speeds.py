"""tribocosim speeds."""

from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any

import typer

from ..packages import check_study_packages
from .completion import ScenarioName
from .error_report import report_errors
from .json_output import Json, build_reporter, print_json
from .options import Restart, Workers, folder_option


@report_errors
def run_speeds(  # noqa: PLR0913  # options of a command
    scenario: ScenarioName,
    low: Annotated[
        str, typer.Option("--from", metavar="SPEED", help="Lowest speed of the flywheel.")
    ] = "500 rpm",
    high: Annotated[str, typer.Option("--to", metavar="SPEED", help="Highest speed.")] = "4000 rpm",
    count: Annotated[int, typer.Option(min=2, help="Number of speeds.")] = 36,
    out: Annotated[Path | None, folder_option("results/SCENARIO-speeds")] = None,
    set_: Annotated[
        list[str] | None,
        typer.Option(
            "--set",
            metavar="PATH=VALUE",
            help="Change the scenario; PATH=A,B,C sweeps each value and puts them side by side.",
        ),
    ] = None,
    workers: Workers = None,
    second_film: Annotated[
        str | None,
        typer.Option(
            help="Find the separation speed with this film formula too; the scenario's own formula: don't.",
            show_default="dowson_toyoda",
        ),
    ] = None,
    separation: Annotated[
        bool, typer.Option("--separation/--no-separation", help="Find the speed at which contact is lost.")
    ] = True,
    overwrite: Restart = False,
    as_json: Json = False,
) -> int:
    """Find the steady cycles of a valve train over speed, and the speed at which contact is lost.

    The same command continues an interrupted sweep. Exit status 0: all cycles found, 1: some failed, 2: a
    mistake in the scenario or the command, 130: interrupted.
    """
    check_study_packages()
    from orchestrator.study.run import Where
    from orchestrator.study.speeds.sweep import Swept, parse_range, sweep
    from orchestrator.study.speeds.variants import list_variants, sweep_variants

    from ..scenario import read_tables

    speeds = parse_range(low, high, count)
    variants = list_variants(set_ or [])
    designs = {variant: read_tables(scenario, variant.settings) for variant in variants}
    folder = out or Path("results") / f"{designs[variants[0]]['name']}-speeds"
    where, reporter = Where(workers=workers), build_reporter(as_json)

    def sweep_one(tables: Mapping[str, Any], place: Path) -> Swept:
        return sweep(tables, speeds, place, where, reporter, overwrite, second_film, separation)

    if len(variants) > 1:
        every = sweep_variants(designs, folder, reporter, sweep_one)
        if as_json:
            print_json({label: one.summary for label, one in every.items()})
        return max(one.status for one in every.values())
    found = sweep_one(designs[variants[0]], folder)
    if as_json:
        print_json({**found.summary, "table": found.table.to_dict()})
    return found.status
