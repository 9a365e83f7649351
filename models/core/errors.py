"""The one family of errors: each is a mistake of the user, or the failure of a run."""

import difflib
from collections.abc import Iterable

from .remedies import ExplainedError


class MistakeError(ExplainedError, ValueError):
    """What was asked for cannot be done; nothing was run or written."""


class ModelError(MistakeError):
    """A system that cannot be built or evaluated."""


class RunError(ExplainedError):
    """A run that cannot go on; what was computed before it is valid."""


def fold_elements(names: Iterable[str]) -> list[str]:
    """Names in which an array's elements stand as one: gap[1..9]."""
    found: dict[str, list[str]] = {}
    for name in names:
        stem, _, index = name.partition("[")
        found.setdefault(stem if index.rstrip("]").isdigit() else name, []).append(name)
    return [every[0] if len(every) == 1 else f"{stem}[1..{len(every)}]" for stem, every in found.items()]


def suggestion(name: str, known: Iterable[str]) -> str:
    """The end of a message: the nearest known name, or all of them."""
    names = list(known)
    close = difflib.get_close_matches(name[:100], names, n=1)
    return f"did you mean {close[0]}?" if close else f"known: {', '.join(fold_elements(names))}"
