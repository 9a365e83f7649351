"""Load an FMU's library without a change of the working folder, which all threads share."""

import contextlib
import os
import threading
from collections.abc import Iterator
from typing import Any

import fmpy.fmi1

_lock = threading.Lock()


@contextlib.contextmanager
def stay_in_folder() -> Iterator[None]:
    """fmpy goes into the library's folder to load it, and stays there where that fails.

    Only Windows looks there for what the library needs. Elsewhere other threads would write files there.
    """
    with _lock:
        if os.name == "nt":
            with contextlib.chdir("."):
                yield
            return
        fmpy.fmi1.os = _StayingOs()
        try:
            yield
        finally:
            fmpy.fmi1.os = os


class _StayingOs:
    """The module `os`, whose `chdir` does nothing."""

    def __getattr__(self, name: str) -> Any:
        return getattr(os, name)

    def chdir(self, path: str) -> None:
        pass
