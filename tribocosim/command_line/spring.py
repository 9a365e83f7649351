"""tribocosim spring."""

from pathlib import Path
from typing import Annotated

import typer

from .error_report import report_errors
from .json_output import Json, build_reporter, print_json


@report_errors
def print_spring(
    source: Annotated[
        str | None,
        typer.Argument(
            help="A scenario whose spring has a wire, or a cam: a lift table (.csv) or a law.",
            show_default=False,
        ),
    ] = None,
    component: Annotated[str | None, typer.Option(help="Spring of the scenario.")] = None,
    cam: Annotated[str | None, typer.Option(help="Component of the scenario with its cam.")] = None,
    set_: Annotated[
        list[str] | None,
        typer.Option(
            "--set",
            metavar="PARAMETER=VALUE",
            help="Set a parameter, e.g. 'pitch=8 mm'; 'tribocosim analyse spring --parameters' lists them.",
        ),
    ] = None,
    out: Annotated[
        Path | None, typer.Option(help="Output folder.", show_default="results/SOURCE-spring")
    ] = None,
    overwrite: Annotated[bool, typer.Option("--overwrite", help="Replace a result in the folder.")] = False,
    as_json: Json = False,
) -> None:
    """Compute a valve spring from its wire: rate, stress, fatigue, surge, and the cam's orders."""
    from orchestrator.analyses._cam_source import find_spring_settings
    from orchestrator.analyses._evaluate import analyse

    found = find_spring_settings(source, component, cam, set_ or [])
    settings = [f"{name}={value}" for name, value in found.items() if value != ""]
    folder = out or Path("results") / (f"{Path(source).stem}-spring" if source else "spring")
    result = analyse("spring", [*settings, *(set_ or [])], folder, overwrite, build_reporter(as_json))
    if as_json:
        print_json(result)
