"""The benchmark: all masters and peers on one problem, as table, netCDF, CSV and figure."""

from __future__ import annotations

import os
import platform
from collections.abc import Iterator
from importlib import metadata
from pathlib import Path

from ...analyses._evaluate import create_folder, find_results
from ...reporter import Reporter
from ...scenario.system import Builder
from . import methods, peers
from .problem import CouplingProblem, build_problem
from .row import Row, build_fmus
from .table import build_dataset, build_digest, format_progress, list_failures, write_csv, write_files

NAME = "coupling"
# Columns of a window in which the digest has room for all its numbers.
WIDEST = 200


def benchmark(
    name: str,
    build: Builder,
    out: Path,
    duration: float | None = None,
    overwrite: bool = False,
    reporter: Reporter | None = None,
) -> list[Row]:
    """Measure, print the digest and write NAME.nc, NAME.csv and NAME.png into `out`.

    NAME-unfinished.csv has the rows of each method as soon as it is measured, and is removed at the end.
    """
    reporter = reporter or Reporter()
    problem = build_problem(name, duration)
    held = find_results(out, NAME, overwrite)
    unfinished = out / f"{NAME}-unfinished.csv"
    rows: list[Row] = []
    with create_folder(out):
        with reporter.stage(f"{problem.name}: {problem.description}") as bar:
            for done, found in measure(problem, build):
                rows += found
                write_csv(build_dataset(rows, problem.outputs, {}), unfinished)
                bar.show(done)
                reporter.line(f"{100.0 * done:3.0f} %  {format_progress(found)}")
        table = build_dataset(rows, problem.outputs, describe_conditions(problem))
        for file in held:
            file.unlink()
        files = write_files(table, rows, problem, out, NAME)
        unfinished.unlink()
    whole = build_digest(rows)
    # A narrow window folds lines, but cuts no numbers.
    console = reporter.console
    whole.width = console.measure(whole, options=console.options.update(max_width=WIDEST)).maximum
    console.print(whole, crop=False)
    for line in list_failures(rows):
        reporter.line(line)
    if problem.uncertainty > 0.0:
        reporter.line(f"the reference's own uncertainty: {problem.uncertainty:.1e}")
    reporter.line(f"results in {out}: {', '.join(file.name for file in files)}")
    return rows


def measure(problem: CouplingProblem, build: Builder) -> Iterator[tuple[float, list[Row]]]:
    """The rows of one method or tool after the other, and the share of all runs that is done."""
    files = build_fmus(problem, build)
    planned = [method.settings(problem) for method in methods.METHODS]
    total = sum(map(len, planned)) + len(problem.held_ladder) * len(peers.PEERS)
    done = 0
    for method, settings in zip(methods.METHODS, planned, strict=True):
        done += len(settings)
        yield done / total, [methods.measure_method(problem, files, method, setting) for setting in settings]
    for peer in peers.PEERS:
        done += len(problem.held_ladder)
        yield done / total, list(peers.measure_peer(problem, files, peer))


def describe_conditions(problem: CouplingProblem) -> dict[str, str | float]:
    """Versions, machine and problem, on which the results depend."""
    packages = ("tribocosim", "numpy", "numba", "fmpy", "pythonfmu", *peers.PACKAGES)
    found = {d.metadata["Name"] for d in metadata.distributions()}
    versions = ", ".join(f"{name} {metadata.version(name)}" for name in packages if name in found)
    return {
        "title": f"Work and precision of co-simulation masters: {problem.description}",
        "problem": problem.name,
        "duration": problem.duration,
        "sample_spacing": problem.spacing,
        "reference_uncertainty": problem.uncertainty,
        "versions": versions,
        "machine": f"Python {platform.python_version()}, {platform.system()} {platform.machine()}, "
        f"{os.cpu_count()} cores",
    }
