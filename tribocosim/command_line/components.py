"""tribocosim components."""

from __future__ import annotations

from typing import Annotated

import typer

from .completion import complete_component
from .error_report import report_errors


@report_errors
def print_components(
    names: Annotated[
        list[str] | None,
        typer.Argument(help="Components.", show_default="all", autocompletion=complete_component),
    ] = None,
) -> None:
    """Print the components' parameters, start values, inputs and outputs, as Markdown."""
    from orchestrator.scenario.components import write_page

    print(write_page(names or ()), end="")
