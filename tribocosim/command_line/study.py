"""tribocosim study."""

from pathlib import Path
from typing import Annotated

import typer

from ..packages import check_study_packages
from .completion import complete_study
from .error_report import report_errors
from .json_output import Json, build_reporter, print_json
from .options import Workers


@report_errors
def run_study(
    study: Annotated[
        str,
        typer.Argument(help="A shipped study, or the path of a .toml file.", autocompletion=complete_study),
    ],
    out: Annotated[
        Path | None, typer.Option(help="The zarr store.", show_default="results/STUDY.zarr")
    ] = None,
    scheduler: Annotated[
        str | None,
        typer.Option(metavar="ADDRESS", help="Use a running dask scheduler, e.g. tcp://host:8786."),
    ] = None,
    workers: Workers = None,
    timeout: Annotated[float, typer.Option(min=0.1, help="Time to wait for the scheduler (s).")] = 10.0,
    retry_failed: Annotated[bool, typer.Option("--retry-failed", help="Repeat failed points.")] = False,
    overwrite: Annotated[bool, typer.Option("--overwrite", help="Replace the store and start over.")] = False,
    as_json: Json = False,
) -> int:
    """Run a parameter study. The same command continues an interrupted study.

    Exit status 0: all points done, 1: some failed (their messages are in the store), 2: a mistake in the
    study or the command, 3: the workers cannot go on, 130: interrupted.
    """
    from orchestrator.errors import MistakeError, Option

    check_study_packages()
    from orchestrator.study.files import load
    from orchestrator.study.run import Where, run

    from ..cached_fmus import build_fmu

    if scheduler and workers:
        remedy = "leave it out with ", Option("scheduler")
        raise MistakeError((Option("workers"), ": are processes on this machine"), remedy)
    plan = load(study, build_fmu)
    store = out or Path("results") / f"{plan.study.name}.zarr"
    where, reporter = Where(scheduler, workers, timeout), build_reporter(as_json)
    status = run(plan, store, where, reporter, overwrite, retry_failed)
    if as_json:
        import xarray

        with xarray.open_zarr(store) as found:
            print_json(found.load().to_dict())
    return status
