"""tribocosim cam."""

from pathlib import Path
from typing import Annotated

import typer

from .error_report import report_errors
from .json_output import Json, build_reporter, print_json


@report_errors
def draw_cam(  # noqa: PLR0913  # options of a command
    source: Annotated[
        str, typer.Argument(help="A lift table (.csv), a law such as cycloidal, or a scenario with a cam.")
    ],
    component: Annotated[str | None, typer.Option(help="Component of the scenario with the cam.")] = None,
    base_radius: Annotated[str | None, typer.Option(help="Base circle radius, e.g. '18 mm'.")] = None,
    follower: Annotated[
        str | None, typer.Option(help="Follower: flat, roller, pad, finger_roller or finger_pad.")
    ] = None,
    radius: Annotated[
        str | None, typer.Option("--radius", "--roller-radius", help="Radius of roller or pad.")
    ] = None,
    speed: Annotated[str | None, typer.Option(help="Speed of the cam, e.g. '3000 rpm'.")] = None,
    set_: Annotated[
        list[str] | None,
        typer.Option(
            "--set",
            metavar="PARAMETER=VALUE",
            help="Set a parameter, e.g. 'offset=2 mm'; 'tribocosim analyse cam --parameters' lists them.",
        ),
    ] = None,
    out: Annotated[
        Path | None, typer.Option(help="Output folder.", show_default="results/SOURCE-cam")
    ] = None,
    overwrite: Annotated[bool, typer.Option("--overwrite", help="Replace a result in the folder.")] = False,
    as_json: Json = False,
) -> None:
    """Check a cam, its timing and contour; write tables, figure, drawings, lift tables and an .s96 file."""
    from orchestrator.analyses._cam_source import find_settings
    from orchestrator.analyses._evaluate import analyse

    options = {"base_radius": base_radius, "follower": follower, "radius": radius, "speed": speed}
    given = {name: value for name, value in options.items() if value is not None}
    settings = [f"{name}={value}" for name, value in (find_settings(source, component) | given).items()]
    folder = out or Path("results") / f"{Path(source).stem}-cam"
    found = analyse("cam", [*settings, *(set_ or [])], folder, overwrite, build_reporter(as_json))
    if as_json:
        print_json(found)
