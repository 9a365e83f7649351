"""`python -m reproduction SOURCE` draws the figures of a published source and checks its statements."""

from pathlib import Path
from typing import Annotated

import typer

from models.core.system import suggestion
from orchestrator.errors import MistakeError
from tribocosim.command_line.error_report import report_errors

from . import SOURCES, load_publication

app = typer.Typer(add_completion=False, pretty_exceptions_enable=False)


@app.command()
@report_errors
def reproduce(
    source: Annotated[str, typer.Argument(help=f"A published source: {', '.join(SOURCES)}.")],
    out: Annotated[Path | None, typer.Option(help="Output folder.", show_default="results/SOURCE")] = None,
    overwrite: Annotated[bool, typer.Option("--overwrite", help="Replace a result in the folder.")] = False,
) -> None:
    """Draw the figures of a published source and check its quantitative statements."""
    if source not in SOURCES:
        raise MistakeError(f"no source {source!r} to reproduce; {suggestion(source, SOURCES)}")
    load_publication(source).reproduce(out or Path("results") / source, overwrite)


if __name__ == "__main__":
    app(prog_name="python -m reproduction")
