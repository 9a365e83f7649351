"""tribocosim clearance."""

from pathlib import Path
from typing import Annotated

import typer

from .error_report import report_errors
from .json_output import Json, build_reporter, print_json


@report_errors
def print_clearance(
    source: Annotated[
        str, typer.Argument(help="A lift table (.csv), a law such as cycloidal, or a scenario with a cam.")
    ],
    component: Annotated[str | None, typer.Option(help="Component of the scenario with the cam.")] = None,
    set_: Annotated[
        list[str] | None,
        typer.Option(
            "--set",
            metavar="PARAMETER=VALUE",
            help="Set a parameter, e.g. 'lash=0.2 mm'; 'tribocosim analyse clearance --parameters' has all.",
        ),
    ] = None,
    out: Annotated[
        Path | None, typer.Option(help="Output folder.", show_default="results/SOURCE-clearance")
    ] = None,
    overwrite: Annotated[bool, typer.Option("--overwrite", help="Replace a result in the folder.")] = False,
    as_json: Json = False,
) -> None:
    """Compute the clearance between valve and piston over the crank angle, with the phases of a phaser."""
    from orchestrator.analyses._cam_source import find_lift_settings
    from orchestrator.analyses._evaluate import analyse

    settings = [f"{name}={value}" for name, value in find_lift_settings(source, component).items()]
    reporter = build_reporter(as_json)
    folder = out or Path("results") / f"{Path(source).stem}-clearance"
    result = analyse("clearance", [*settings, *(set_ or [])], folder, overwrite, reporter)
    least = float(result["least_over_phases"])
    if least < 0.0:
        reporter.line(f"the valve meets the piston: least clearance {1e3 * least:.3g} mm over all phases")
    if as_json:
        print_json(result)
