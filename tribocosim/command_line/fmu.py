"""tribocosim fmu."""

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import asdict
from pathlib import Path
from typing import Annotated, Any

import typer

from ..messages import say, show, tell_replaced
from .completion import complete_component
from .error_report import report_errors
from .json_output import Json, print_json
from .options import Settings


@report_errors
def fmu_build(  # noqa: PLR0913  # options of a command
    names: Annotated[
        list[str] | None,
        typer.Argument(
            help="Names of components; your own as module:factory.",
            show_default="all",
            autocompletion=complete_component,
        ),
    ] = None,
    out: Annotated[Path, typer.Option(help="Folder for the .fmu files.")] = Path("."),
    structure: Annotated[
        list[str] | None, typer.Option(help="Set a structural size, e.g. coil_masses=8; may be repeated.")
    ] = None,
    native: Annotated[
        bool, typer.Option("--native", help="Build native FMUs, which need no Python: NAME-native.fmu.")
    ] = False,
    platform: Annotated[
        list[str] | None,
        typer.Option(
            help="With --native: target platform; may be repeated.", show_default="all but wasm32-wasip2"
        ),
    ] = None,
    fmi: Annotated[int, typer.Option(help="FMI version 2 or 3 (with --native: NAME-native-fmi3.fmu).")] = 2,
    scenario: Annotated[
        str | None, typer.Option(help="Scenario whose components are built, with its values as defaults.")
    ] = None,
    set_: Settings = None,
    whole: Annotated[
        bool, typer.Option("--whole", help="With --scenario: all its components as one FMU, SCENARIO.fmu.")
    ] = False,
    outside: Annotated[
        list[str] | None,
        typer.Option(
            help="With --whole: component to leave out, whose outputs become inputs; may be repeated."
        ),
    ] = None,
) -> None:
    """Build FMUs of components.

    With --scenario NAMES are components of the scenario: parameters, tables, oil and start values become the
    FMUs' defaults.
    """
    from orchestrator.errors import MistakeError, Option
    from orchestrator.scenario.files import read
    from orchestrator.scenario.units import format_time

    from ..fmu import FmuOptions, build_file, check_options, check_place
    from ..scenario import Scenario
    from ..scenario_fmus import build_scenario_fmus, plan_experiment

    if scenario is None:
        for option, given in (("set", set_), ("whole", whole), ("outside", outside)):
            if given:
                remedy = "add ", Option("scenario", "FILE")
                raise MistakeError((Option(option), ": only with a scenario"), remedy)
        sizes = dict(map(_parse_size, structure)) if structure else None
        options = FmuOptions(sizes, native, platform, fmi)
        found = check_options(names, options)
        check_place(out, found)
        for name in found:
            with tell_replaced(_list_fmus(out)), _show_progress(name, native) as progress:
                show(build_file(name, out, options, progress))
        return
    if structure:
        raise MistakeError((Option("structure"), ": a scenario's components have its sizes"))
    built = scenario if whole or not names else f"{', '.join(names)} of {scenario}"
    wanted = Scenario(*read(scenario, set_ or []))
    with tell_replaced(_list_fmus(out)), _show_progress(built, native) as progress:
        files = build_scenario_fmus(
            wanted, out, components=names or (), whole=whole,
            outside=outside or (), native=native, platforms=platform or (), fmi=fmi, progress=progress,
        )  # fmt: skip
    for file in files:
        show(file)
        if whole:
            _tell_replaced_starts(file)
            step = format_time(plan_experiment(wanted.check()).step_size)
            say(f"{file}: take an output interval of {step} or less: a host sees no peak between its times")


def _tell_replaced_starts(file: Path) -> None:
    """Of inputs that drive several parts, which start otherwise on their own."""
    from models.core.composite import REPLACES

    from ..fmu import fmu_info as describe

    for variable in describe(file).variables:
        if REPLACES in variable.description:
            say(f"{file}: {variable.name}: {variable.description[variable.description.index(REPLACES) :]}")


def _list_fmus(out: Path) -> Sequence[Path]:
    return [out] if out.suffix == ".fmu" else list(out.glob("*.fmu"))


@contextmanager
def _show_progress(name: str, native: bool) -> Iterator[Callable[[str], None]]:
    """Yield a function that shows the steps of a native build on a terminal; else one line at the start."""
    if not native:
        yield lambda step: None
        return
    from rich.console import Console

    console = Console(stderr=True, highlight=False)
    begun = False
    with console.status(f"native FMU {name}") as status:

        def show_step(step: str) -> None:
            nonlocal begun
            if not begun and not console.is_terminal:
                say(f"building the native FMU {name} (once; up to minutes)")
            begun = True
            status.update(f"native FMU {name}: {step}")

        yield show_step


def _parse_size(text: str) -> tuple[str, int]:
    """Parse NAME=NUMBER."""
    from orchestrator.errors import MistakeError, Option

    name, _, number = text.partition("=")
    try:
        return name.strip(), int(number)
    except ValueError:
        rule = ": must be NAME=NUMBER with a whole number, e.g. coil_masses=8"
        raise MistakeError((Option("structure", text), rule)) from None


@report_errors
def fmu_validate(
    files: Annotated[list[Path], typer.Argument(help="The .fmu files.")], as_json: Json = False
) -> int:
    """Check whether FMU files conform to the standard and run here, a few steps each.

    Exit status 1 if there is a finding.
    """
    from ..fmu import validate_fmu

    found = {file: validate_fmu(_check_file(file)) for file in files}
    if as_json:
        print_json(found)
    for file, findings in () if as_json else found.items():
        show(f"{file}: {findings}")
    return 1 if any(found.values()) else 0


@report_errors
def fmu_compare(
    files: Annotated[list[Path], typer.Argument(help="The .fmu files, or folders to search for them.")],
    tolerance: Annotated[
        float | None,
        typer.Option(
            help="Allowed difference, relative to a variable's largest value.",
            show_default="RelTol of the .opt file",
        ),
    ] = None,
    as_json: Json = False,
) -> int:
    """Run FMUs and compare them with their reference results, inside the file or beside it.

    Exit status 1: one differs, 2: one has no reference or does not run.
    """
    from fmus.reference_results.compare import compare_in_process
    from fmus.reference_results.files import ComparisonError
    from orchestrator.errors import MistakeError, Option, in_command_line

    if tolerance is not None and not tolerance > 0.0:
        raise MistakeError((Option("tolerance", tolerance), ": must be > 0"))
    paths: list[Path] = []
    for file in files:
        below = sorted(file.rglob("*.fmu")) if file.is_dir() else [_check_file(file)]
        if not below:
            raise MistakeError(f"{file}: has no .fmu files")
        paths += below
    status = 0
    results: dict[Path, Any] = {}
    for path, found in compare_in_process(paths, tolerance):
        if isinstance(found, ComparisonError):
            text = in_command_line(found)
            say(text)
            status, results[path] = 2, text
            continue
        results[path] = {**asdict(found), "agrees": found.agrees}
        if not as_json:
            show(f"{path}\n{found}")
        if not found.agrees:
            status = status or 1
    if as_json:
        print_json(results)
    return status


@report_errors
def fmu_info(file: Annotated[Path, typer.Argument(help="The .fmu file.")], as_json: Json = False) -> None:
    """Show the capabilities and variables of an FMU."""
    from ..fmu import fmu_info as describe

    found = describe(_check_file(file))
    if as_json:
        print_json(found)
    else:
        show(found)


def _check_file(file: Path) -> Path:
    from orchestrator.errors import Command, MistakeError

    if file.is_dir():
        raise MistakeError(f"{file}: is a folder; give its files: {file / '*.fmu'}")
    if not file.is_file():
        raise MistakeError(f"{file}: no such file", (Command("fmu build"), " makes the FMUs"))
    return file
