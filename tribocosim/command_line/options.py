"""Options that several commands have."""

from typing import Annotated, Any

import typer

Settings = Annotated[
    list[str] | None,
    typer.Option(
        "--set",
        metavar="PATH=VALUE",
        help="Change the scenario, e.g. components.camshaft.parameters.lift='9 mm'.",
    ),
]
Workers = Annotated[
    int | None, typer.Option(min=1, help="Processes on this machine.", show_default="one a core")
]
Overwrite = Annotated[bool, typer.Option("--overwrite", help="Replace a result in the folder.")]
Restart = Annotated[bool, typer.Option("--overwrite", help="Replace the results and start over.")]


def folder_option(default: str) -> Any:
    """The option of the output folder; `default` is shown as its default."""
    return typer.Option(help="Output folder.", show_default=default)


def parameter_option(help: str) -> Any:
    """The option `--set` for the parameters of an analysis."""
    return typer.Option("--set", metavar="PARAMETER=VALUE", help=help)
