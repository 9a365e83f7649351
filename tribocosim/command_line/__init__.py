"""The command `tribocosim`. Its commands are in the files here.

Slow imports are inside functions, so that --help answers at once.
"""

from typing import Annotated

import typer

from .analyse import run_analysis
from .apart import remember_arguments
from .cams import draw_cam, print_clearance, print_spring
from .cycles import compare_sweeps, run_sensitivities, run_speeds, run_tolerances, run_wear
from .fmu import fmu_build, fmu_compare, fmu_info, fmu_validate
from .lists import list_scenarios, print_components
from .misuse import Commands
from .results import print_diagnosis, print_friction, write_page
from .run import resume_run, run_scenario
from .ssp import ssp_export, ssp_import
from .studies import design_cam, run_calibrate, run_masters, run_study

app = typer.Typer(
    cls=Commands,
    help="Co-simulation of valve train and slider-crank tribodynamics, compared with a monolithic reference.",
    no_args_is_help=True,
    pretty_exceptions_enable=False,
)
app.command("run")(run_scenario)
app.command("resume")(resume_run)
app.command("scenarios")(list_scenarios)
app.command("components")(print_components)
app.command("report")(write_page)
app.command("diagnose")(print_diagnosis)
app.command("friction")(print_friction)
app.command("analyse")(run_analysis)
app.command("masters")(run_masters)
app.command("cam")(draw_cam)
app.command("clearance")(print_clearance)
app.command("spring")(print_spring)
app.command("speeds")(run_speeds)
app.command("calibrate")(run_calibrate)
app.command("sensitivities")(run_sensitivities)
app.command("tolerances")(run_tolerances)
app.command("design")(design_cam)
app.command("compare")(compare_sweeps)
app.command("study")(run_study)
app.command("wear")(run_wear)

fmus = typer.Typer(help="Build, inspect and check FMUs.", no_args_is_help=True)
fmus.command("build")(fmu_build)
fmus.command("validate")(fmu_validate)
fmus.command("info")(fmu_info)
fmus.command("compare")(fmu_compare)
app.add_typer(fmus, name="fmu")

packages = typer.Typer(help="Exchange scenarios with other tools.", no_args_is_help=True)
packages.command("export")(ssp_export)
packages.command("import")(ssp_import)
app.add_typer(packages, name="ssp")


def main() -> None:
    """Run the command line."""
    remember_arguments()
    app()


def _print_version(asked: bool) -> None:
    if asked:
        from importlib import metadata

        typer.echo(f"tribocosim {metadata.version('tribocosim')}")
        raise typer.Exit


@app.callback()
def _options(
    version: Annotated[
        bool, typer.Option("--version", callback=_print_version, is_eager=True, help="Show the version.")
    ] = False,
) -> None:
    pass
