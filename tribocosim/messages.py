"""Messages on standard error."""

import sys


def say(text: str) -> None:
    """Print each line with the name of the program."""
    for line in text.split("\n"):
        print(f"tribocosim: {line}", file=sys.stderr)
