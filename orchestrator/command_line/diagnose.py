"""tribocosim diagnose."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from .error_report import report_errors


@report_errors
def print_diagnosis(
    folder: Annotated[Path, typer.Argument(help="A run's output folder.")],
    figure: Annotated[Path | None, typer.Option(help="Draw the steps into this file (.png).")] = None,
) -> None:
    """Say what limited the steps of a run, finished or killed, and what would help."""
    from ..assessment.diagnosis.command import diagnose
    from ..run.report import Reporter

    diagnose(folder, figure, Reporter().line)
