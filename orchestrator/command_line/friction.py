"""tribocosim friction."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from .error_report import report_errors

# m2/N: boundary-lubricated steel has 1e-18 to 1e-16.
COEFFICIENT = 1e-17


@report_errors
def print_friction(
    folder: Annotated[Path, typer.Argument(help="A run's output folder, of a valve train.")],
    contact: Annotated[str | None, typer.Option(help="One contact.", show_default="all")] = None,
    wear_coefficient: Annotated[
        float, typer.Option(help="Wear volume over load times sliding distance, in m2/N.")
    ] = COEFFICIENT,
    cycles: Annotated[float, typer.Option(help="Revolutions that the wear is extrapolated over.")] = 1e8,
    table: Annotated[
        Path | None, typer.Option(help="Write the revolution into this file (.csv, .json or .nc).")
    ] = None,
    figure: Annotated[
        Path | None, typer.Option(help="Draw the revolution into this file (.png, .svg or .pdf).")
    ] = None,
) -> None:
    """Report friction and wear of a valve train's contacts over the last cam revolution of a run."""
    from ..assessment.friction.command import friction
    from ..run.report import Reporter

    friction(folder, contact, wear_coefficient, cycles, table, figure, Reporter())
