"""tribocosim scenarios."""

from __future__ import annotations

from typing import Annotated

import typer

from .reported import reported


@reported
def scenarios(
    schema: Annotated[
        bool, typer.Option("--schema", help="Print the JSON schema of scenario files.")
    ] = False,
) -> None:
    """List the shipped scenarios."""
    if schema:
        from ..scenario.schema import text

        print(text(), end="")
        return
    import tomllib

    from ..scenario.files import shipped

    for name, path in shipped().items():
        print(f"{name:24} {tomllib.loads(path.read_text('utf-8')).get('description', '')}")
