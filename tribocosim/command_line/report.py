"""tribocosim report."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from .error_report import report_errors


@report_errors
def write_page(
    folder: Annotated[Path, typer.Argument(help="A run's output folder.")],
    out: Annotated[
        Path | None, typer.Option(help="The page's file.", show_default="FOLDER/report.html")
    ] = None,
) -> None:
    """Make the page of a run anew: its mechanism in motion, plots, errors, in one file for a browser."""
    from orchestrator.report import write_report
    from orchestrator.reporter import Reporter

    Reporter().line(f"report in {write_report(folder, out)}")
