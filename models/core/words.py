"""Words of messages."""


def tally(number: int, noun: str) -> str:
    """A number of things: "1 signal", "2 signals", "2 entries"; of a noun with more words its last."""
    many = f"{noun[:-1]}ies" if noun.endswith("y") else f"{noun}s"
    return f"{number} {noun if number == 1 else many}"
