"""tribocosim components."""

from typing import Annotated

import typer

from ..messages import show
from .completion import complete_component
from .error_report import report_errors
from .json_output import Json, print_json


@report_errors
def print_components(
    names: Annotated[
        list[str] | None,
        typer.Argument(help="Names of components.", show_default="all", autocompletion=complete_component),
    ] = None,
    as_json: Json = False,
) -> None:
    """Print parameters, start values, inputs and outputs of components as Markdown."""
    from orchestrator.scenario.components import describe_components, write_page

    if as_json:
        print_json(describe_components(names or ()))
        return
    show(write_page(names or ()), end="")
