"""tribocosim speeds."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Annotated

import typer

from .error_report import report_errors
from .study import check_packages


@report_errors
def run_speeds(
    scenario: Annotated[str, typer.Argument(help="A shipped scenario, or the path of a .toml file.")],
    low: Annotated[
        str, typer.Option("--from", metavar="SPEED", help="Lowest speed of the flywheel.")
    ] = "500 rpm",
    high: Annotated[str, typer.Option("--to", metavar="SPEED", help="Highest speed.")] = "4000 rpm",
    count: Annotated[int, typer.Option(min=2, help="Number of speeds.")] = 36,
    out: Annotated[
        Path | None, typer.Option(help="Output folder.", show_default="results/SCENARIO-speeds")
    ] = None,
    set_: Annotated[
        list[str] | None, typer.Option("--set", metavar="PATH=VALUE", help="Change the scenario.")
    ] = None,
    workers: Annotated[
        int | None, typer.Option(min=1, help="Processes on this machine.", show_default="one a core")
    ] = None,
    overwrite: Annotated[
        bool, typer.Option("--overwrite", help="Start over, replacing the results.")
    ] = False,
) -> int:
    """Find the steady cycles of a valve train over speed, and the speed at which contact is lost.

    Stopped at any moment, the same command continues. Exit status 0: all cycles found, 1: some failed, 2: a
    mistake in the scenario or the command, 130: interrupted.
    """
    check_packages()
    from ..errors import MistakeError
    from ..scenario.files import load
    from ..speeds.subject import SPEED
    from ..speeds.sweep import Range, sweep
    from ..study.run import Where

    for name, value in (("--from", low), ("--to", high)):
        if doubt := SPEED.doubt(name, value):
            raise MistakeError(doubt)
    ends = [float(SPEED.check_value(name, value)) for name, value in (("--from", low), ("--to", high))]
    if not ends[0] < ends[1]:
        rpm = [f"{end * 30.0 / math.pi:.4g} rpm" for end in ends]
        raise MistakeError(f"--from {low} ({rpm[0]}): must be less than --to {high} ({rpm[1]})")
    folder = out or Path("results") / f"{load(scenario).name}-speeds"
    return sweep(
        scenario, set_ or [], Range(ends[0], ends[1], count), folder, Where(workers=workers), overwrite
    )
