"""tribocosim cam, clearance and spring: analyses of a scenario, a lift table or a law."""

from pathlib import Path
from typing import Annotated

import typer

from .error_report import report_errors
from .json_output import Json, build_reporter, print_json
from .options import Overwrite, folder_option, parameter_option

CamSource = Annotated[
    str, typer.Argument(help="A lift table (.csv), a law such as cycloidal, or a scenario with a cam.")
]
CamComponent = Annotated[str | None, typer.Option(help="Component of the scenario with the cam.")]


@report_errors
def draw_cam(  # noqa: PLR0913  # options of a command
    source: CamSource,
    component: CamComponent = None,
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
        parameter_option(
            "Set a parameter, e.g. 'offset=2 mm'; 'tribocosim analyse cam --parameters' lists them."
        ),
    ] = None,
    out: Annotated[Path | None, folder_option("results/SOURCE-cam")] = None,
    overwrite: Overwrite = False,
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


@report_errors
def print_clearance(
    source: CamSource,
    component: CamComponent = None,
    set_: Annotated[
        list[str] | None,
        parameter_option(
            "Set a parameter, e.g. 'lash=0.2 mm'; 'tribocosim analyse clearance --parameters' has all."
        ),
    ] = None,
    out: Annotated[Path | None, folder_option("results/SOURCE-clearance")] = None,
    overwrite: Overwrite = False,
    as_json: Json = False,
) -> None:
    """Compute the clearance between valve and piston over the crank angle, with the phases of a phaser."""
    from orchestrator.analyses._cam_source import find_lift_settings, find_valve_settings
    from orchestrator.analyses._evaluate import analyse

    found = find_lift_settings(source, component) | find_valve_settings(source, component)
    settings = [f"{name}={value}" for name, value in found.items()]
    reporter = build_reporter(as_json)
    folder = out or Path("results") / f"{Path(source).stem}-clearance"
    result = analyse("clearance", [*settings, *(set_ or [])], folder, overwrite, reporter)
    least = float(result["least_over_phases"])
    if least < 0.0:
        reporter.line(f"the valve meets the piston: least clearance {1e3 * least:.3g} mm over all phases")
    if as_json:
        print_json(result)


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
        parameter_option(
            "Set a parameter, e.g. 'pitch=8 mm'; 'tribocosim analyse spring --parameters' lists them."
        ),
    ] = None,
    out: Annotated[Path | None, folder_option("results/SOURCE-spring")] = None,
    overwrite: Overwrite = False,
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
