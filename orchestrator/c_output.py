"""Where this process prints: descriptors of its streams, and what C libraries hold in their buffers."""

import ctypes
import os
from typing import Any

_LINES = {"posix": 1}.get(os.name)  # _IOLBF of setvbuf


def write_lines_at_once() -> None:
    """Have every line that C code prints written when it ends: a process that dies takes none along."""
    if _LINES is None:
        return
    c = ctypes.CDLL(None)
    name = "stdout" if hasattr(c, "stdout") else "__stdoutp"  # macOS
    c.setvbuf(ctypes.c_void_p.in_dll(c, name), None, _LINES, ctypes.c_size_t(0))


def flush() -> None:
    """Write what C code has printed."""
    if _LINES is not None:
        ctypes.CDLL(None).fflush(None)


def find_descriptor(stream: Any) -> int | None:
    """The descriptor of a Python stream; None for one that has none."""
    try:
        return int(stream.fileno())
    except (OSError, ValueError):
        return None
