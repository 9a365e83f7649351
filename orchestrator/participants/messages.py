"""Messages between a run and the process of an FMU: kind, length, content."""

from __future__ import annotations

import struct
from typing import Any

CALL, ADVANCE, READ, DONE, FAILED = b"c", b"a", b"r", b"d", b"f"
HEAD = struct.Struct("=cQ")
TIMES = struct.Struct("=dd")  # begin and length of a step (s)


def send(pipe: Any, kind: bytes, *parts: bytes) -> None:
    """Write to an unbuffered pipe; OSError if it is closed."""
    content = b"".join(parts)
    rest = memoryview(HEAD.pack(kind, len(content)) + content)
    while rest:
        rest = rest[pipe.write(rest) :]


def receive(pipe: Any) -> tuple[bytes, bytes]:
    """Read the next message from an unbuffered pipe; EOFError if it is closed."""
    kind, size = HEAD.unpack(_exactly(pipe, HEAD.size))
    return kind, _exactly(pipe, size)


def _exactly(pipe: Any, size: int) -> bytes:
    found = pipe.read(size) if size else b""
    while len(found) < size:
        more = pipe.read(size - len(found))
        if not more:
            raise EOFError
        found += more
    return found
