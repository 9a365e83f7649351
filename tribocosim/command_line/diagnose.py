"""tribocosim diagnose."""

from pathlib import Path
from typing import Annotated

import typer

from .error_report import report_errors
from .json_output import Json, build_reporter, print_json


@report_errors
def print_diagnosis(
    folder: Annotated[
        Path,
        typer.Argument(help="Output folder of a run; or a scenario, by name or file, for its newest run."),
    ],
    figure: Annotated[Path | None, typer.Option(help="Draw the steps to this file (.png).")] = None,
    as_json: Json = False,
) -> None:
    """Report where the time of a run went, who limits its steps, and what to change."""
    from orchestrator.assessment.diagnosis.report import diagnose
    from orchestrator.errors import MistakeError, Option
    from orchestrator.plots.steps import draw_steps
    from orchestrator.plots.style import save_figure
    from orchestrator.store.output_folder import writing

    if figure and figure.suffix != ".png":
        raise MistakeError((Option("figure", figure), ": must end in .png"))
    reporter = build_reporter(as_json)
    found = diagnose(folder)
    if as_json:
        print_json(
            {
                "diagnosis": found.diagnosis,
                "effort": found.spending.effort,
                "stages": found.spending.stages,
                "suggestions": found.suggestions,
            }
        )
    for line in found.lines:
        reporter.line(line)
    if figure:
        with writing(figure, "figure"):
            save_figure(lambda: draw_steps(found.steps, found.scenario.name), figure)
        reporter.line(f"figure in {figure}")
