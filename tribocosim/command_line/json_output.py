"""The option --json: the result on standard output as JSON, everything else on standard error."""

from __future__ import annotations

import json
import math
from dataclasses import asdict, is_dataclass
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
    show(json.dumps(_to_plain(content), indent=2, allow_nan=False))


def _to_plain(value: Any) -> Any:
    if is_dataclass(value) and not isinstance(value, type):
        return _to_plain(asdict(value))
    if isinstance(value, dict):
        return {str(key): _to_plain(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [_to_plain(item) for item in value]
    if isinstance(value, bool | int | str | type(None)):
        return value
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    if hasattr(value, "item"):  # a number of numpy, which only some commands import
        return _to_plain(value.item())
    return str(value)
