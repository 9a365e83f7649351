"""What commands print beside the lines of a run: nothing in it commands the terminal."""

import sys
from typing import Any


def show(content: Any, end: str = "\n") -> None:
    """Print to standard output."""
    print(_clean(str(content)), end=end, flush=True)


def say(text: str) -> None:
    """Print each line with the name of the program to standard error."""
    for line in _clean(text).split("\n"):
        print(f"tribocosim: {line}", file=sys.stderr)


def _clean(text: str) -> str:
    from models.core.remedies import make_printable  # with numpy, which `--help` does not need

    return make_printable(text)
