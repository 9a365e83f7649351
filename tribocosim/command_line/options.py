"""Options that several commands have."""

from typing import Annotated

import typer

Settings = Annotated[
    list[str] | None, typer.Option("--set", metavar="PATH=VALUE", help="Change the scenario.")
]
Workers = Annotated[
    int | None, typer.Option(min=1, help="Processes on this machine.", show_default="one a core")
]
Restart = Annotated[bool, typer.Option("--overwrite", help="Replace the results and start over.")]
