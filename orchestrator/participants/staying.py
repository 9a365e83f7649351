"""Load an FMU's library without a change of the working folder, which all threads share."""

from __future__ import annotations

import contextlib
import os
import threading
from collections.abc import Iterator
from typing import Any
from unittest import mock

import fmpy.fmi1

_lock = threading.Lock()


@contextlib.contextmanager
def stay_in_folder() -> Iterator[None]:
    """fmpy goes into the library's folder to load it, and stays there where that fails.

    Only Windows looks there for what the library needs. Elsewhere other threads would write files there.
    """
    with _lock, contextlib.ExitStack() as stack:
        if os.name == "nt":
            stack.enter_context(contextlib.chdir("."))
        else:
            stack.enter_context(mock.patch.object(fmpy.fmi1, "os", _StayingOs()))
        yield


class _StayingOs:
    """The module `os`, whose `chdir` does nothing."""

    def __getattr__(self, name: str) -> Any:
        return getattr(os, name)

    def chdir(self, path: str) -> None:
        pass
