"""tribocosim diagnose."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from .error_report import report_errors
from .json_output import Json, build_reporter, print_json


@report_errors
def print_diagnosis(
    folder: Annotated[Path, typer.Argument(help="Output folder of a run.")],
    figure: Annotated[Path | None, typer.Option(help="Draw the steps to this file (.png).")] = None,
    as_json: Json = False,
) -> None:
    """Report what limited the steps of a run, also an interrupted one, and suggest remedies."""
    from orchestrator.assessment.diagnosis.report import diagnose
    from orchestrator.errors import MistakeError
    from orchestrator.plots.steps import draw_steps
    from orchestrator.plots.style import save_figure

    if figure and figure.suffix != ".png":
        raise MistakeError(f"--figure {figure}: must end in .png")
    reporter = build_reporter(as_json)
    found = diagnose(folder)
    if as_json:
        print_json({"diagnosis": found.diagnosis, "suggestions": found.suggestions})
    for line in found.lines:
        reporter.line(line)
    if figure:
        try:
            reporter.line(
                f"figure in {save_figure(lambda: draw_steps(found.steps, found.scenario.name), figure)}"
            )
        except OSError as error:
            raise MistakeError(
                f"--figure {figure}: cannot be written ({error.strerror}); choose another"
            ) from None
