"""tribocosim compare."""

from pathlib import Path
from typing import Annotated

import typer

from ..messages import tell_replaced
from ..packages import check_study_packages
from .error_report import report_errors
from .json_output import Json, build_reporter, print_json


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
    as_json: Json = False,
) -> None:
    """Compare two designs over speed, or two runs, in numbers and a figure.

    Over speed: the speed of separation, and the worst value of each number over the speeds at which both keep
    contact. Of two runs: their figures of merit with angle or time unless zero in both, and their trains
    over the angle.
    """
    check_study_packages()
    from orchestrator.errors import MistakeError, Option
    from orchestrator.store.output_folder import is_run
    from orchestrator.study.run_overlay import compare_runs
    from orchestrator.study.speeds.compare import compare, parse_choice

    if out.suffix.lower() not in ("", ".png"):
        raise MistakeError((Option("out", out), f": must be a PNG file, such as {out.with_suffix('.png')}"))
    out = out.with_suffix(".png")
    reporter = build_reporter(as_json)
    if is_run(first) or is_run(second):
        for name, given in (("from", low), ("to", high), ("at", at), ("lost", lost or None)):
            if given is not None:
                raise MistakeError((Option(name, given), ": only for two sweeps over speed"))
        with tell_replaced([out]):
            found = compare_runs(first, second, out, reporter)
    else:
        choice = parse_choice(low, high, at, lost)
        with tell_replaced([out]):
            found = compare(first, second, out, reporter, choice)
    if as_json:
        print_json(found)
