"""The one family of errors: each is a mistake of the user, or the failure of a run."""

import difflib
import re
from collections.abc import Iterable

from .remedies import ExplainedError

ELEMENT = re.compile(r"\[\d+\](?=[^\[]*$)")


class MistakeError(ExplainedError, ValueError):
    """What was asked for cannot be done; nothing was run or written."""


class ModelError(MistakeError):
    """A system that cannot be built or evaluated."""


class RunError(ExplainedError):
    """A run that cannot go on; what was computed before it is valid."""


def group_elements(names: Iterable[str]) -> dict[str, list[str]]:
    """The names by what they stand as: elements of an array, by their last index, as gap[1..9]."""
    found: dict[str, list[str]] = {}
    for name in names:
        found.setdefault(ELEMENT.sub("[]", name), []).append(name)
    return {
        every[0] if len(every) == 1 else stem.replace("[]", f"[1..{len(every)}]"): every
        for stem, every in found.items()
    }


def suggestion(name: str, known: Iterable[str]) -> str:
    """The end of a message: the nearest known name, or all of them."""
    names = list(known)
    close = difflib.get_close_matches(name[:100], names, n=1)
    return f"did you mean {close[0]}?" if close else f"known: {', '.join(group_elements(names))}"
