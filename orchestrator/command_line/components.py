"""tribocosim components."""

from __future__ import annotations

from typing import Annotated

import typer

from .reported import reported


@reported
def components(
    names: Annotated[list[str] | None, typer.Argument(help="Components.", show_default="all")] = None,
) -> None:
    """Print the components' parameters, start values, inputs and outputs, as Markdown."""
    from ..scenario.components import page

    print(page(names or ()), end="")
