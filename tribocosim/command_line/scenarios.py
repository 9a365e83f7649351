"""tribocosim scenarios."""

from __future__ import annotations

from typing import Annotated

import typer

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

        print(write_schema(), end="")
        return
    import tomllib

    from orchestrator.scenario.files import list_shipped

    found = {
        name: tomllib.loads(path.read_text("utf-8")).get("description", "")
        for name, path in list_shipped().items()
    }
    if as_json:
        print_json(found)
        return
    for name, description in found.items():
        print(f"{name:24} {description}")
