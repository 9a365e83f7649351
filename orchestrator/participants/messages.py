"""Messages between a run and the process of an FMU: a mark, kind, length, content.

The FMU can write to any descriptor of its process. The mark tells what it writes there from a message.
"""

import struct
import time as clock
from typing import Any

CALL, ADVANCE, READ, DONE, FAILED = b"c", b"a", b"r", b"d", b"f"
HEAD = struct.Struct("=8scQ")
MARK = b"tribocos"
LARGEST = 1 << 30  # bytes of a message
CHUNK = 1 << 20  # bytes that are reserved before they have come
TIMES = struct.Struct("=dd")  # begin and length of a step (s)


def send(pipe: Any, kind: bytes, *parts: bytes) -> None:
    """Write to an unbuffered pipe; OSError if it is closed."""
    content = b"".join(parts)
    rest = memoryview(HEAD.pack(MARK, kind, len(content)) + content)
    while rest:
        rest = rest[pipe.write(rest) :]


def receive(pipe: Any, limit: float | None = None) -> tuple[bytes, bytes]:
    """Read the next message from an unbuffered pipe.

    EOFError if it is closed, TimeoutError if the message has not come within `limit` (s), ValueError if it is
    none, or too large.
    """
    end = None if limit is None else clock.monotonic() + limit
    mark, kind, size = HEAD.unpack(_read(pipe, HEAD.size, end))
    if mark != MARK or size > LARGEST:
        raise ValueError(f"a message of {size} bytes" if mark == MARK else "no message")
    return kind, _read(pipe, size, end)


def _read(pipe: Any, size: int, end: float | None) -> bytes:
    found = bytearray()
    while len(found) < size:
        if end is not None:
            _wait(pipe, end)
        more = pipe.read(min(size - len(found), CHUNK))
        if not more:
            raise EOFError
        found += more
    return bytes(found)


def _wait(pipe: Any, end: float) -> None:
    """Until there is something to read; TimeoutError at the time `end` of the monotonic clock."""
    import select

    waiting = select.poll()
    waiting.register(pipe, select.POLLIN)
    if not waiting.poll(1e3 * max(0.0, end - clock.monotonic())):
        raise TimeoutError
