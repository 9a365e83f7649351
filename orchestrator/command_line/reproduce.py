"""tribocosim reproduce."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from .reported import reported


@reported
def reproduce_source(
    source: Annotated[str, typer.Argument(help="A published source: farahanchi1991, films or kushwaha2000.")],
    out: Annotated[Path | None, typer.Option(help="Output folder.", show_default="results/SOURCE")] = None,
    overwrite: Annotated[bool, typer.Option("--overwrite", help="Replace a result in the folder.")] = False,
) -> None:
    """Draw the figures of a published source and check its quantitative statements."""
    from models.system import suggestion

    from ..errors import MistakeError
    from ..reproduce import SOURCES, publication

    if source not in SOURCES:
        raise MistakeError(f"no source {source!r} to reproduce; {suggestion(source, SOURCES)}")
    publication(source).reproduce(out or Path("results") / source, overwrite)
