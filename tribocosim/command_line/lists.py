"""tribocosim scenarios and components: what is shipped."""

from typing import Annotated

import typer

from ..messages import show
from .completion import complete_component
from .error_report import report_errors
from .json_output import Json, print_json


@report_errors
def list_scenarios(
    schema: Annotated[
        bool, typer.Option("--schema", help="Print the JSON schema of scenario files.")
    ] = False,
    as_json: Json = False,
) -> None:
    """List the shipped scenarios."""
    if schema:
        from orchestrator.scenario.schema import write_schema

        show(write_schema(), end="")
        return
    from ..scenario import scenarios

    found = scenarios()
    if as_json:
        print_json(found)
        return
    for name, description in found.items():
        show(f"{name:24} {description}")


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
