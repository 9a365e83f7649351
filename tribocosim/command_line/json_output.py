"""The option --json: the result on standard output as JSON, everything else on standard error."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Annotated, Any

import typer

from ..messages import show

if TYPE_CHECKING:
    from orchestrator.reporter import Reporter

Json = Annotated[
    bool, typer.Option("--json", help="Print the result as JSON; messages go to standard error.")
]


def build_reporter(as_json: bool, verbose: bool = False) -> Reporter:
    """A reporter whose lines leave standard output to the JSON."""
    from orchestrator.reporter import SafeConsole

    from .printed import CommandReporter

    return CommandReporter(SafeConsole(stderr=True) if as_json else None, verbose)


def print_json(content: Any) -> None:
    """Plain values, also of numpy, and dataclasses as JSON; numbers that it has not become null."""
    from orchestrator.texts import to_plain

    show(json.dumps(to_plain(content), indent=2, allow_nan=False))
