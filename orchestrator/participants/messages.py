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
SMALL = 1 << 12  # bytes that are read at once: most messages
TIMES = struct.Struct("=dd")  # begin and length of a step (s)


def send(pipe: Any, kind: bytes, *parts: bytes) -> None:
    """Write to an unbuffered pipe; OSError if it is closed."""
    content = b"".join(parts)
    rest = memoryview(HEAD.pack(MARK, kind, len(content)) + content)
    while rest:
        rest = rest[pipe.write(rest) :]


def receive(pipe: Any, limit: float | None = None) -> tuple[bytes, bytes]:
    """Read the next message from an unbuffered pipe, on which another one comes only after an answer.

    EOFError if it is closed, TimeoutError if the message has not come within `limit` (s), ValueError if it is
    none, or too large.
    """
    end = None if limit is None else clock.monotonic() + limit
    found = _read(pipe, HEAD.size, SMALL, end)
    mark, kind, size = HEAD.unpack_from(found)
    if mark != MARK or size > LARGEST:
        raise ValueError(f"a message of {size} bytes" if mark == MARK else "no message")
    content = found[HEAD.size :]
    if len(content) < size:
        content += _read(pipe, size - len(content), CHUNK, end)
    if len(content) > size:
        raise ValueError("more than a message")
    return kind, content


def _read(pipe: Any, least: int, most: int, end: float | None) -> bytes:
    """At least so many bytes, with not more than `most` at a time."""
    found = bytearray()
    while len(found) < least:
        if end is not None:
            _wait(pipe, end)
        more: bytes = pipe.read(most)
        if len(more) >= least:
            return more
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
