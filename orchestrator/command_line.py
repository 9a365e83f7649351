"""The command `tribocosim`. Imports what is slow only where it is used: --help must answer at once."""

from __future__ import annotations

import functools
import os
import sys
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Annotated, Any

import typer

from .interruption import Noticed

MISTAKE, FAILED, INTERRUPTED = 2, 3, 130

app = typer.Typer(
    help="Co-simulation of valve train and slider-crank tribodynamics, compared with a monolithic reference.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
)
fmu_app = typer.Typer(help="Build and inspect the FMUs.", no_args_is_help=True)
app.add_typer(fmu_app, name="fmu")
benchmark_app = typer.Typer(help="Measure masters, ours and other tools'.", no_args_is_help=True)
app.add_typer(benchmark_app, name="benchmark")


def main() -> None:
    """Run the command line."""
    app()


def reported(command: Callable[..., int | None]) -> Callable[..., None]:
    """Exit with the status that `command` returns. An error is one message on standard error, without a
    traceback (TRIBOCOSIM_DEBUG=1 shows it)."""

    @functools.wraps(command)
    def report(*arguments: Any, **options: Any) -> None:
        noticed = Noticed()
        try:
            with noticed:
                status = command(*arguments, **options)
        except KeyboardInterrupt as interruption:
            _say(str(interruption) or "interrupted")
            raise typer.Exit(INTERRUPTED) from None
        except Exception as error:
            if noticed.asked:
                _say("interrupted")
                raise typer.Exit(INTERRUPTED) from None
            if os.environ.get("TRIBOCOSIM_DEBUG", "0").strip("0"):
                raise
            text, status = _judged(error)
            _say(text)
        raise typer.Exit(status or 0)

    return report


def _judged(error: Exception) -> tuple[str, int]:
    """The message for the user, and the exit status."""
    from models.system import ModelError

    from .errors import MistakeError, RunError

    if isinstance(error, (MistakeError, ModelError)):
        return str(error), MISTAKE
    if isinstance(error, RunError):
        return str(error), FAILED
    return f"unexpected {type(error).__name__}: {error} (TRIBOCOSIM_DEBUG=1 shows where)", FAILED


def _say(text: str) -> None:
    for line in text.split("\n"):
        print(f"tribocosim: {line}", file=sys.stderr)


def _version(asked: bool) -> None:
    if asked:
        from importlib import metadata

        print(f"tribocosim {metadata.version('tribocosim')}")
        raise typer.Exit


@app.callback()
def _options(
    version: Annotated[
        bool, typer.Option("--version", callback=_version, is_eager=True, help="Show the version.")
    ] = False,
) -> None:
    pass


@app.command("run")
@reported
def run_scenario(
    scenario: Annotated[str, typer.Argument(help="A shipped scenario, or the path of a .toml file.")],
    out: Annotated[Path | None, typer.Option(help="Output folder. [default: results/SCENARIO]")] = None,
    set_: Annotated[
        list[str] | None,
        typer.Option(
            "--set",
            metavar="PATH=VALUE",
            help="Change the scenario, e.g. components.camshaft.parameters.lift='9 mm'.",
        ),
    ] = None,
    master: Annotated[str | None, typer.Option(help="Use another master.")] = None,
    overwrite: Annotated[bool, typer.Option("--overwrite", help="Replace a result in the folder.")] = False,
    no_figures: Annotated[bool, typer.Option("--no-figures", help="Draw no figures.")] = False,
) -> int:
    """Run a scenario; exit status 0 if it is within its tolerance of the reference.

    1: outside the tolerance, 2: a mistake in the scenario or the command, 3: the run failed,
    4: not compared (reference.enabled=false), 130: interrupted.
    """
    from .output_folder import spare
    from .report import Reporter
    from .run import run
    from .scenario_files import find, load

    overrides = [f"master.name={master}"] if master else []
    loaded = load(scenario, overrides + (set_ or []))
    folder = out or Path("results") / loaded.name
    spare(find(scenario), loaded, folder)
    summary = run(loaded, folder, _fmu, Reporter(), overwrite, figures=not no_figures)
    if not summary.complete:
        _say(summary.message)
    return summary.exit_status


@app.command("resume")
@reported
def resume_run(
    folder: Annotated[Path, typer.Argument(help="The output folder of the run.")],
    no_figures: Annotated[bool, typer.Option("--no-figures", help="Draw no figures.")] = False,
) -> int:
    """Continue a run that was killed or interrupted from its last checkpoint, with the same results.

    Exit status as of `run`; 2 also if the run cannot go on (another FMU, version or scenario, or a damaged
    checkpoint).
    """
    from .report import Reporter
    from .resume import resume

    summary = resume(folder, _fmu, Reporter(), figures=not no_figures)
    if not summary.complete:
        _say(summary.message)
    return summary.exit_status


def _fmu(name: str, structure: Mapping[str, int]) -> Path:
    """The packaged component, built if it isn't in the cache."""
    from fmus.build import build
    from models.kernel import user_cache_directory

    from .errors import RunError

    try:
        return build(name, structure=structure)
    except OSError as error:
        raise RunError(
            f"building the FMU {name}: {user_cache_directory()} cannot be written ({error.strerror}); set "
            "TRIBOCOSIM_CACHE to a folder that can"
        ) from None
    except (KeyError, ValueError) as error:
        raise RunError(f"building the FMU {name}: {error.args[-1] if error.args else error}") from None


@app.command()
@reported
def scenarios(
    schema: Annotated[
        bool, typer.Option("--schema", help="Print the JSON schema of scenario files.")
    ] = False,
) -> None:
    """List the shipped scenarios."""
    if schema:
        from .schema import text

        print(text(), end="")
        return
    import tomllib

    from .scenario_files import shipped

    for name, path in shipped().items():
        print(f"{name:24} {tomllib.loads(path.read_text('utf-8')).get('description', '')}")


@app.command("diagnose")
@reported
def diagnose_run(
    folder: Annotated[Path, typer.Argument(help="A run's output folder.")],
    figure: Annotated[Path | None, typer.Option(help="Draw the steps into this file (.png).")] = None,
) -> None:
    """Say what limited the steps of a run, finished or killed, and what would help."""
    from .diagnosis.command import diagnose
    from .report import Reporter

    diagnose(folder, figure, Reporter().line)


@app.command("analyse")
@reported
def run_analysis(
    name: Annotated[
        str | None,
        typer.Argument(
            help="An analysis, your own as module:object, or a scenario: how each master will do. "
            "[default: list the analyses]"
        ),
    ] = None,
    set_: Annotated[
        list[str] | None,
        typer.Option(
            "--set",
            metavar="PARAMETER=VALUE",
            help="Set a parameter, e.g. damping=0.1 (of a scenario: PATH=VALUE).",
        ),
    ] = None,
    show_parameters: Annotated[
        bool, typer.Option("--parameters", help="List the parameters and compute nothing.")
    ] = False,
    at: Annotated[
        list[str] | None,
        typer.Option(metavar="TIME", help="Linearise a scenario at this instant too, e.g. '30 ms'."),
    ] = None,
    out: Annotated[
        Path | None,
        typer.Option(help="Output folder. [default: results/NAME, or results/SCENARIO-stability]"),
    ] = None,
    overwrite: Annotated[bool, typer.Option("--overwrite", help="Replace a result in the folder.")] = False,
) -> None:
    """Analyse one motion or machine, or a scenario's coupling: results, table (netCDF, CSV) and figure."""
    from .analyse import analyse, listed, parameters
    from .errors import MistakeError
    from .report import Reporter
    from .stability.command import analyse_scenario, is_scenario

    reporter = Reporter()
    if name is None:
        reporter.console.print(listed())
    elif is_scenario(name) and show_parameters:
        raise MistakeError(f"--parameters: {name} is a scenario; --set changes any of its keys, as for run")
    elif is_scenario(name):
        analyse_scenario(name, set_ or [], at or [], out, overwrite, reporter)
    elif at:
        raise MistakeError(f"--at: belongs to a scenario, which {name} is not; leave it out")
    elif show_parameters:
        reporter.console.print(parameters(name))
    else:
        analyse(name, set_ or [], out, overwrite, reporter)


@app.command("study")
@reported
def run_study(
    study: Annotated[str, typer.Argument(help="A shipped study, or the path of a .toml file.")],
    out: Annotated[Path | None, typer.Option(help="The zarr store. [default: results/STUDY.zarr]")] = None,
    scheduler: Annotated[
        str | None,
        typer.Option(metavar="ADDRESS", help="Use a dask scheduler that runs, e.g. tcp://host:8786."),
    ] = None,
    workers: Annotated[
        int | None, typer.Option(min=1, help="Processes on this machine. [default: one a core]")
    ] = None,
    timeout: Annotated[
        float, typer.Option(min=0.1, help="Seconds to wait for the scheduler's answer.")
    ] = 10.0,
    retry_failed: Annotated[bool, typer.Option("--retry-failed", help="Try failed points again.")] = False,
    overwrite: Annotated[bool, typer.Option("--overwrite", help="Start over, replacing the store.")] = False,
) -> int:
    """Run a parameter study; stopped at any moment, the same command continues it.

    Exit status 0: all points done, 1: some failed (their messages are in the store), 2: a mistake in the
    study or the command, 3: the workers cannot go on, 130: interrupted.
    """
    from .errors import MistakeError
    from .report import Reporter
    from .study.files import load
    from .study.run import Where, run

    if scheduler and workers:
        raise MistakeError("--workers: are processes on this machine; leave it out with --scheduler")
    plan = load(study, _fmu)
    store = out or Path("results") / f"{plan.study.name}.zarr"
    return run(plan, store, Where(scheduler, workers, timeout), Reporter(), overwrite, retry_failed)


@app.command("reproduce")
@reported
def reproduce_source(
    source: Annotated[str, typer.Argument(help="A published source: farahanchi1991 or kushwaha2000.")],
    out: Annotated[Path | None, typer.Option(help="Output folder. [default: results/SOURCE]")] = None,
    overwrite: Annotated[bool, typer.Option("--overwrite", help="Replace a result in the folder.")] = False,
) -> None:
    """Draw the figures of a published source and check its quantitative statements."""
    from models.system import suggestion

    from .errors import MistakeError
    from .reproduce import SOURCES, publication

    if source not in SOURCES:
        raise MistakeError(f"no source {source!r} to reproduce; {suggestion(source, SOURCES)}")
    publication(source).reproduce(out or Path("results") / source, overwrite)


@benchmark_app.command("coupling")
@reported
def benchmark_coupling(
    problem: Annotated[str, typer.Option(help="quarter-car, two-masses or valve-train.")] = "quarter-car",
    out: Annotated[
        Path | None, typer.Option(help="Output folder. [default: results/benchmark-PROBLEM]")
    ] = None,
    duration: Annotated[float | None, typer.Option(help="Simulated time in seconds.")] = None,
    overwrite: Annotated[bool, typer.Option("--overwrite", help="Replace a result in the folder.")] = False,
) -> None:
    """Error against doStep calls and wall time: all masters, and other tools that are installed, on the same
    FMUs."""
    from .work_precision.benchmark import benchmark

    benchmark(problem, _fmu, out or Path("results") / f"benchmark-{problem}", duration, overwrite)


@fmu_app.command("build")
@reported
def fmu_build(
    names: Annotated[list[str] | None, typer.Argument(help="Components. [default: all]")] = None,
    out: Annotated[Path, typer.Option(help="Folder for the .fmu files.")] = Path("."),
) -> None:
    """Build FMUs."""
    from fmus.build import NAMES, build
    from models.system import suggestion

    from .errors import MistakeError

    for name in names or NAMES:
        if name not in NAMES:
            raise MistakeError(f"no FMU {name!r}; {suggestion(name, NAMES)}")
        try:
            print(build(name, out))
        except OSError as error:
            raise MistakeError(f"{out}: cannot be written ({error.strerror}); choose another --out") from None


@fmu_app.command("validate")
@reported
def fmu_validate(files: Annotated[list[Path], typer.Argument(help="The .fmu files.")]) -> int:
    """Check FMU files; exit status 1 if something is found."""
    from fmus.validate import validate

    found = 0
    for file in files:
        problems = validate(_existing(file))
        found += len(problems)
        print(f"{file}: {'nothing found' if not problems else ''}")
        for problem in problems:
            print(f"  {problem}")
    return 1 if found else 0


@fmu_app.command("info")
@reported
def fmu_info(file: Annotated[Path, typer.Argument(help="The .fmu file.")]) -> None:
    """Show what an FMU is and its variables."""
    from fmus.validate import FmuFileError, info

    from .errors import MistakeError

    try:
        print(info(_existing(file)))
    except FmuFileError as error:
        raise MistakeError(str(error)) from None


def _existing(file: Path) -> Path:
    from .errors import MistakeError

    if file.is_dir():
        raise MistakeError(f"{file}: is a folder; give its files: {file / '*.fmu'}")
    if not file.is_file():
        raise MistakeError(f"{file}: no such file; tribocosim fmu build makes the FMUs")
    return file
