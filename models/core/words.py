"""Words of messages."""


def tally(number: int, noun: str) -> str:
    """A number of things: "1 signal", "2 signals"."""
    return f"{number} {noun}{'s' * (number != 1)}"
