"""An FMU in this process that calls `exit` does not end the command silently, with whatever status it gives.

The C library calls functions at `exit`, of which Python knows nothing: one of them tells what has happened
and ends the process as a failure. It is there only while FMUs are called that may do this: when the process
ends as it should, Python is gone by then.
"""

from __future__ import annotations

import ctypes
import os
import platform
import sys
from collections.abc import Callable
from contextlib import AbstractContextManager, nullcontext
from types import TracebackType

from .record import FAILED

_AtExit = ctypes.CFUNCTYPE(None, ctypes.c_void_p)


def guarding(tell: Callable[[], None] | None) -> AbstractContextManager[ExitGuard | None]:
    """In its `with` block `exit` calls `tell`, and its status is that of a failure; None: nothing is done.

    Where the C library is glibc or macOS' own; elsewhere nothing is done either. `_exit` gets past it.
    """
    known = platform.libc_ver()[0] == "glibc" or sys.platform == "darwin"
    return ExitGuard(tell) if tell is not None and known else nullcontext()


class ExitGuard:
    """See `guarding`."""

    def __init__(self, tell: Callable[[], None]) -> None:
        self._tell = tell
        self._armed = True
        self._called = _AtExit(self._exiting)
        # By the Itanium C++ ABI (3.3.6), a library that is unloaded has its functions called, and forgotten.
        # This one is known by an address that no library has.
        self._library = ctypes.create_string_buffer(1)
        self._c = ctypes.CDLL(None)

    def __enter__(self) -> ExitGuard:
        self._c.__getattr__("__cxa_atexit")(self._called, None, self._library)
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._armed = False
        self._c.__getattr__("__cxa_finalize")(self._library)

    def _exiting(self, argument: int | None) -> None:
        if not self._armed:
            return
        try:
            self._tell()
            sys.stdout.flush()
            sys.stderr.flush()
        finally:
            os._exit(FAILED)
