"""The benchmark: all masters and peers on one problem, as table, netCDF, CSV and figure."""

from __future__ import annotations

import os
import platform
from collections.abc import Callable, Iterator
from importlib import metadata
from pathlib import Path

from ..analyse import made, results_in
from ..assembly import Builder
from ..report import Reporter
from . import methods, peers
from .problem import CouplingProblem, problem_named
from .run import Row, fmu_files
from .table import dataset, digest, failures, write

NAME = "coupling"


def benchmark(
    name: str,
    build: Builder,
    out: Path,
    duration: float | None = None,
    overwrite: bool = False,
    reporter: Reporter | None = None,
) -> list[Row]:
    """Measure, print the digest and write NAME.nc, NAME.csv and NAME.png into `out`."""
    reporter = reporter or Reporter()
    problem = problem_named(name, duration)
    held = results_in(out, NAME, overwrite)
    with made(out):
        with reporter.stage(f"{problem.name}: {problem.description}") as bar:
            rows = measure(problem, build, bar.show)
        table = dataset(rows, problem.outputs, about(problem))
        for file in held:
            file.unlink()
        files = write(table, rows, problem, out, NAME)
    reporter.console.print(digest(rows))
    for line in failures(rows):
        reporter.line(line)
    if problem.uncertainty > 0.0:
        reporter.line(f"the reference's own uncertainty: {problem.uncertainty:.1e}")
    reporter.line(f"results in {out}: {', '.join(file.name for file in files)}")
    return rows


def measure(
    problem: CouplingProblem, build: Builder, progress: Callable[[float], None] = lambda share: None
) -> list[Row]:
    """All rows."""
    files = fmu_files(problem, build)
    every = [(method, setting) for method in methods.METHODS for setting in method.settings(problem)]

    def runs() -> Iterator[Row]:
        for method, setting in every:
            yield methods.measured(problem, files, method, setting)
        for peer in peers.PEERS:
            yield from peers.measured(problem, files, peer)

    expected = len(every) + len(problem.held_ladder) * len(peers.PEERS)
    rows = []
    for row in runs():
        rows.append(row)
        progress(min(1.0, len(rows) / expected))
    return rows


def about(problem: CouplingProblem) -> dict[str, str | float]:
    """What the numbers depend on."""
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
