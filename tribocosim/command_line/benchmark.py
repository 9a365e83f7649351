"""tribocosim benchmark."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from .error_report import report_errors


@report_errors
def benchmark_coupling(
    problem: Annotated[
        str,
        typer.Option(help="quarter-car, two-masses, precice-oscillator, mass-spring-damper or valve-train."),
    ] = "quarter-car",
    out: Annotated[
        Path | None, typer.Option(help="Output folder.", show_default="results/benchmark-PROBLEM")
    ] = None,
    duration: Annotated[float | None, typer.Option(help="Simulated time in seconds.")] = None,
    overwrite: Annotated[bool, typer.Option("--overwrite", help="Replace a result in the folder.")] = False,
) -> None:
    """Measure error over doStep calls and wall time of masters and installed tools with the same FMUs."""
    from orchestrator.study.work_precision.benchmark import benchmark

    from ..cached_fmus import build_fmu

    benchmark(problem, build_fmu, out or Path("results") / f"benchmark-{problem}", duration, overwrite)
