"""What commands print beside the lines of a run: nothing in it commands the terminal."""

import sys
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any


def show(content: Any, end: str = "\n") -> None:
    """Print to standard output."""
    print(_clean(str(content)), end=end, flush=True)


def say(text: str) -> None:
    """Print each line with the name of the program to standard error."""
    for line in _clean(text).split("\n"):
        print(f"tribocosim: {line}", file=sys.stderr)


@contextmanager
def tell_replaced(files: Iterable[Path]) -> Iterator[None]:
    """Say which of the files the block has replaced by others."""
    before = {file: file.read_bytes() for file in files if file.is_file()}
    yield
    for file, content in before.items():
        if file.read_bytes() != content:
            say(f"{file}: replaced a different file of this name")


def _clean(text: str) -> str:
    from models.core.remedies import make_printable  # with numpy, which `--help` does not need

    return make_printable(text)
