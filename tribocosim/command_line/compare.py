"""tribocosim compare."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from ..packages import check_study_packages
from .error_report import report_errors


@report_errors
def compare_sweeps(
    first: Annotated[Path, typer.Argument(help="The output folder of `tribocosim speeds` for one design.")],
    second: Annotated[Path, typer.Argument(help="The folder of the other.")],
    out: Annotated[Path, typer.Option(help="The figure.")] = Path("results/compare.png"),
) -> int:
    """Compare two designs over speed: the worst of every number, separation, and a figure of both."""
    check_study_packages()
    from orchestrator.speeds.compare import compare

    compare(first, second, out)
    return 0
