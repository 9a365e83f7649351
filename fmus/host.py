"""What the slave needs of the program that hosts it, through pythonfmu's C layer.

Read from the source of the C layer of pythonfmu 0.7.0 (`PySlaveInstance.cpp`, `Logger.hpp`):

- After an exception it drops its references to the instance, its class and its message list, and drops
  them again when the instance is freed: use after free. One more reference of each makes the count right.
- It passes messages to the host only if the host asked for logging, errors too. The flag is the first
  member of the logger object, whose address the slave is given.
- It makes and destroys a Python thread state around every call from a thread that isn't Python's, which
  takes ten times as long as the call. One more "ensure" for the thread keeps its state.
"""

from __future__ import annotations

import ctypes
import threading
from typing import Any

try:
    from .pythonfmu._version import __version__ as PYTHONFMU
except ImportError:
    from pythonfmu import __version__ as PYTHONFMU

# The C layers whose source was read for what is said above; with others, nothing of it is done.
KNOWN_VERSIONS = ("0.7.0",)

# After the pointer to the table of virtual functions.
_LOGGING_FLAG = ctypes.sizeof(ctypes.c_void_p)

_kept_threads: set[int] = set()


class Host:
    """The host of one slave. `logger` is the address of the C layer's logger, 0 if Python calls directly."""

    def __init__(self, slave: Any, logger: int) -> None:
        self._slave = slave.__class__, slave.log_queue
        self._owner = id(slave)
        self._logger = logger if PYTHONFMU in KNOWN_VERSIONS else 0
        self.present = bool(logger)

    def let_messages_through(self) -> None:
        """From now on pass messages to the host's logger, whether it asked for them or not."""
        if self._logger:
            ctypes.c_ubyte.from_address(self._logger + _LOGGING_FLAG).value = 1

    def survive_exception(self) -> None:
        """To be called once before an exception leaves the slave."""
        if self._logger:
            for thing in self._slave:
                ctypes.pythonapi.Py_IncRef(ctypes.py_object(thing))
            # By address: a reference from here to the slave would be a cycle.
            ctypes.pythonapi.Py_IncRef(ctypes.c_void_p(self._owner))

    def keep_thread_state(self) -> None:
        """Keep the Python state of the calling thread, once per thread, if the thread isn't Python's."""
        ident = threading.get_ident()
        if ident in _kept_threads or not self._logger:
            return
        _kept_threads.add(ident)
        if not any(_is_python(thread) and thread.ident == ident for thread in threading.enumerate()):
            ctypes.pythonapi.PyGILState_Ensure()


def _is_python(thread: threading.Thread) -> bool:
    # A thread from outside shows up as a dummy as soon as it asked for its own name.
    return not isinstance(thread, threading._DummyThread)
