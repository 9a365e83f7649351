"""What interrupts a run: Ctrl-C, and an FMU that calls `exit`.

Ctrl-C is acted on between macro steps: raised inside a Python FMU, it would come back as that FMU's error.
"""

from __future__ import annotations

import ctypes
import os
import platform
import signal
import sys
import threading
from collections.abc import Callable, Sequence
from contextlib import AbstractContextManager, nullcontext
from types import FrameType, TracebackType
from typing import TYPE_CHECKING, Any

from .. import c_output

if TYPE_CHECKING:
    from models.core.quantities import Vector

    from ..engine.step import Step

_AtExit = ctypes.CFUNCTYPE(None, ctypes.c_void_p)


class Noticed:
    """Remembers that Ctrl-C came; it is raised as ever.

    Libraries make other errors of it: numba, broken off while it compiles, one about its half-made code.
    """

    def __init__(self) -> None:
        self.asked = False
        self._previous: Any = None

    def __enter__(self) -> Noticed:
        if threading.current_thread() is threading.main_thread():
            self._previous = signal.getsignal(signal.SIGINT)
            if callable(self._previous):  # not where the command was started without Ctrl-C
                signal.signal(signal.SIGINT, self._notice)
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if callable(self._previous):
            signal.signal(signal.SIGINT, self._previous)

    def _notice(self, number: int, frame: FrameType | None) -> None:
        self.asked = True
        self._previous(number, frame)


class Interruption:
    """An observer that raises KeyboardInterrupt after the macro step in which Ctrl-C came.

    A second Ctrl-C is raised at once. Outside the main thread, which alone gets signals, it does nothing.
    """

    def __init__(self) -> None:
        self.asked = False
        self._previous: Any = None

    def __enter__(self) -> Interruption:
        if threading.current_thread() is threading.main_thread():
            self._previous = signal.signal(signal.SIGINT, self._ask)
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self._previous is not None:
            signal.signal(signal.SIGINT, self._previous)
        if self.asked and kind is None:  # it came in the last step
            raise KeyboardInterrupt

    def _ask(self, number: int, frame: FrameType | None) -> None:
        if self.asked:
            raise KeyboardInterrupt
        self.asked = True

    def begin(self, names: Sequence[str]) -> None:
        pass

    def observe(self, time: float, outputs: Callable[[], Vector], step: Step) -> None:
        if self.asked:
            raise KeyboardInterrupt

    def end(self, complete: bool, message: str) -> None:
        pass


def guard_exit(tell: Callable[[], None] | None, status: int) -> AbstractContextManager[ExitGuard | None]:
    """In its `with` block `exit` calls `tell` and ends the process with `status`; None: nothing is done.

    Where the C library is glibc or macOS' own; elsewhere nothing is done either. `_exit` gets past it.
    """
    known = platform.libc_ver()[0] == "glibc" or sys.platform == "darwin"
    return ExitGuard(tell, status) if tell is not None and known else nullcontext()


class ExitGuard:
    """An FMU in this process that calls `exit` does not end the command silently with a status of its own.

    The C library calls functions at `exit`, of which Python knows nothing. One of them tells what happened
    and ends the process as a failure. It is there only while such FMUs are called: when the process ends as
    it should, Python is gone by then.
    """

    def __init__(self, tell: Callable[[], None], status: int) -> None:
        self._tell, self._status = tell, status
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
            c_output.flush()
            sys.stdout.flush()
            sys.stderr.flush()
        finally:
            os._exit(self._status)
