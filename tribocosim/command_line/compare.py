"""tribocosim compare."""

from pathlib import Path
from typing import Annotated

import typer

from ..packages import check_study_packages
from .error_report import report_errors
from .json_output import Json, build_reporter, print_json


@report_errors
def compare_sweeps(
    first: Annotated[Path, typer.Argument(help="Output folder of `tribocosim speeds` for one design.")],
    second: Annotated[Path, typer.Argument(help="Output folder of the other design.")],
    out: Annotated[Path, typer.Option(help="File of the figure.")] = Path("results/compare.png"),
    as_json: Json = False,
) -> None:
    """Compare two designs over speed: worst value of each number, separation speed, and a figure."""
    check_study_packages()
    from orchestrator.study.speeds.compare import compare

    found = compare(first, second, out, build_reporter(as_json))
    if as_json:
        print_json(found)
