"""tribocosim report."""

from pathlib import Path
from typing import Annotated

import typer

from .error_report import report_errors


@report_errors
def write_page(
    folder: Annotated[
        Path, typer.Argument(help="Output folder of a run or a speed sweep; with --cycle also a scenario.")
    ],
    out: Annotated[
        Path | None,
        typer.Option(
            help="File of the page, or a folder for it.",
            show_default="report.html or cycle.html in FOLDER; of a scenario here",
        ),
    ] = None,
    cycle: Annotated[
        bool,
        typer.Option(
            "--cycle",
            help="Write cycle.html, which computes the train's steady cycle as sliders move (extra native).",
        ),
    ] = False,
) -> None:
    """Rewrite report.html, the page with the animated mechanism, plots and errors, and a run's figures.

    With --out it writes the page only. Exit status 3: a figure or the page failed.
    """
    from orchestrator.reporter import Reporter

    from ..cycle_page import draw_page

    reporter = Reporter()
    reporter.line(f"report in {draw_page(folder, out, cycle, reporter)}")
