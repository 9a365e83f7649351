"""The one family of errors: each is a mistake of the user, or the failure of a run."""

import difflib
import re
from collections.abc import Iterable, Mapping

from .remedies import ExplainedError

MOST = 3  # names that are suggested
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


def suggestion(name: str, known: Iterable[str], meanings: Mapping[str, str] | None = None) -> str:
    """The end of a message: the nearest known names, or all of them.

    These are alike, or have `name` as a part, or as a symbol in their `meanings`: k in "stiffness k_c".
    """
    names, word = list(known), re.escape(name[:100])
    close = difflib.get_close_matches(name[:100], names, n=1)
    for pattern, texts in (
        (rf"(^|_){word}(_|\[|$)", {one: one for one in names}),
        (rf"(?<!\w){word}(_\w+|\d*)(?!\w)", meanings or {}),
    ):
        if not close and name not in ("", "a"):  # the article
            close = [one for one, text in texts.items() if re.search(pattern, text)][:MOST]
    return f"did you mean {' or '.join(close)}?" if close else f"known: {', '.join(group_elements(names))}"
