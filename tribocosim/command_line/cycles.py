"""tribocosim speeds, compare, sensitivities, tolerances and wear: steady cycles of valve trains."""

from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any

import typer

from ..packages import check_study_packages
from .completion import ScenarioName
from .error_report import report_errors
from .json_output import Json, build_reporter, print_json
from .options import Overwrite, Restart, Settings, Workers, folder_option


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


@report_errors
def compare_sweeps(  # options of a command
    first: Annotated[
        Path, typer.Argument(help="Output folder of `tribocosim speeds` for one design, or of a run.")
    ],
    second: Annotated[Path, typer.Argument(help="Output folder of the other design or run.")],
    out: Annotated[Path, typer.Option(help="File of the figure.")] = Path("results/compare.png"),
    low: Annotated[str | None, typer.Option("--from", metavar="SPEED", help="Lowest speed.")] = None,
    high: Annotated[str | None, typer.Option("--to", metavar="SPEED", help="Highest speed.")] = None,
    at: Annotated[
        str | None, typer.Option(metavar="SPEED", help="One speed: the nearest that was computed.")
    ] = None,
    lost: Annotated[
        bool, typer.Option("--lost", help="Include speeds at which one of them loses contact.")
    ] = False,
    overwrite: Annotated[bool, typer.Option("--overwrite", help="Replace an existing figure.")] = False,
    as_json: Json = False,
) -> None:
    """Compare two designs over speed, or two runs, in numbers and a figure.

    Over speed: the speed of separation, and the worst value of each number over the speeds at which both keep
    contact. Of two runs: their figures of merit with angle or time unless zero in both, and their trains
    over the angle.
    """
    check_study_packages()
    from orchestrator.errors import REPLACE, MistakeError, Option, another
    from orchestrator.store.output_folder import is_run
    from orchestrator.study.run_overlay import compare_runs
    from orchestrator.study.speeds.compare import compare, parse_choice

    if out.suffix.lower() not in ("", ".png"):
        raise MistakeError((Option("out", out), f": must be a PNG file, such as {out.with_suffix('.png')}"))
    out = out.with_suffix(".png")
    if out.exists() and not overwrite:
        raise MistakeError(f"{out}: is already there", another(), REPLACE)
    reporter = build_reporter(as_json)
    if is_run(first) or is_run(second):
        for name, given in (("from", low), ("to", high), ("at", at), ("lost", lost or None)):
            if given is not None:
                raise MistakeError((Option(name, given), ": only for two sweeps over speed"))
        found = compare_runs(first, second, out, reporter)
    else:
        found = compare(first, second, out, reporter, parse_choice(low, high, at, lost))
    if as_json:
        print_json(found)


@report_errors
def run_sensitivities(  # noqa: PLR0913  # options of a command
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
    period: Annotated[
        str | None,
        typer.Option(metavar="TIME", help="Period of the cycle, where an FMU of another tool drives it."),
    ] = None,
    run: Annotated[
        bool, typer.Option("--run", help="Of the scenario's run from its start, in place of a steady cycle.")
    ] = False,
    out: Annotated[Path | None, folder_option("results/SCENARIO-sensitivities")] = None,
    set_: Settings = None,
    workers: Workers = None,
    overwrite: Restart = False,
    as_json: Json = False,
) -> int:
    """Find which parameters move a valve train's figures of merit, in its steady cycle or a run; by how much.

    The same command continues an interrupted one. Exit status 0: all cycles found, 1: some failed, 2: a
    mistake in the scenario or the command, 130: interrupted.
    """
    check_study_packages()
    from orchestrator.reporter import tell_interruption
    from orchestrator.scenario import build_scenario
    from orchestrator.study.run import Where
    from orchestrator.study.speeds.sensitivities import Asked, find_asked_sensitivities
    from orchestrator.study.speeds.sensitivities_report import publish

    from ..cached_fmus import build_fmu
    from ..scenario import read_tables

    tables = read_tables(scenario, set_ or [])
    checked = build_scenario(tables)
    folder = out or Path("results") / f"{checked.name}-sensitivities"
    reporter, where = build_reporter(as_json), Where(workers=workers)
    asked = Asked(parameter or [], speed, period, run)
    with tell_interruption():
        found = find_asked_sensitivities(tables, asked, folder, where, build_fmu, reporter, overwrite)
    publish(found, checked, folder, reporter)
    if as_json:
        print_json(found.to_dict())
    return int(found.attrs["status"])


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
    from orchestrator.reporter import tell_interruption
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
    with tell_interruption(lambda: f"the trains are kept in {folder}: the same command continues"):
        found = find_tolerances(tables, given, folder, Where(workers=workers), reporter, overwrite)
        publish(found, limits, f"{name} at {found.attrs['speed_rpm']:.0f} r/min", folder, reporter)
    if as_json:
        print_json(found.drop_vars("sample").to_dict())
    return int(found.attrs["status"])


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
