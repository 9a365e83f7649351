"""What the slave needs of the program that hosts it, through pythonfmu's C layer.

Read from the source of the C layer of pythonfmu 0.7.0 (`PySlaveInstance.cpp`, `Logger.hpp`, `PyState.hpp`):

- After an exception it drops its references to the instance, its class and its message list, and drops
  them again when the instance is freed: use after free. One more reference of each makes the count right.
- It passes messages to the host only if the host asked for logging, errors too. The flag is the first
  member of the logger object, whose address the slave is given.
- It passes the messages that came before an exception while the exception is set. A host's logger in Python
  fails then, from Python 3.13 on. To read such a message clears the exception.
- It makes and destroys a Python thread state around every call from a thread that isn't Python's, which
  takes longer than the call. One more "ensure" for the thread keeps its state.
- At the end of the process it releases the object that starts and stops Python twice: a static variable is
  destroyed, then set to null by the library's destructor. The second release writes into freed memory
  (processes with numba abort). Run before both, its own clean-up function leaves null to them.
"""

import contextlib
import ctypes
import os
import sys
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

_clear_exception = ctypes.pythonapi.PyErr_Clear

attached_threads: set[int] = set()
_closed_in_order: set[bytes] = set()


class LastMessage:
    """A message that an exception follows, with the attributes that the C layer reads."""

    def __init__(self, text: str, status: int, category: str) -> None:
        self.status, self.category, self._text = status, category, text

    @property
    def msg(self) -> str:
        """The first that is read."""
        _clear_exception()
        return self._text


class Host:
    """The host of one slave. `logger` is the address of the C layer's logger, 0 if Python calls directly."""

    def __init__(self, slave: Any, logger: int) -> None:
        self._shared = slave.__class__, slave.log_queue
        # By address: a reference to the slave would be a cycle, and keep it until the next collection.
        self._slave = ctypes.c_void_p(id(slave))
        self._logger = logger if PYTHONFMU in KNOWN_VERSIONS else 0
        self.present = bool(logger)
        if self._logger and sys.platform == "linux":
            with contextlib.suppress(OSError, AttributeError):
                _close_in_order(self._logger)

    def let_messages_through(self) -> None:
        """From now on pass messages to the host's logger, whether it asked for them or not."""
        if self._logger:
            ctypes.c_ubyte.from_address(self._logger + _LOGGING_FLAG).value = 1

    def survive_exception(self) -> None:
        """To be called once before an exception leaves the slave."""
        if self._logger:
            ctypes.pythonapi.Py_IncRef(self._slave)
            for thing in self._shared:
                ctypes.pythonapi.Py_IncRef(ctypes.py_object(thing))

    def keep_thread_state(self) -> None:
        """Keep the Python state of the calling thread, once per thread; Python's own threads lose nothing."""
        ident = threading.get_ident()
        if ident not in attached_threads and self._logger:
            attached_threads.add(ident)
            ctypes.pythonapi.PyGILState_Ensure()


class _SymbolInfo(ctypes.Structure):
    """Dl_info of dlfcn.h."""

    _fields_ = (
        ("file", ctypes.c_char_p),
        ("base", ctypes.c_void_p),
        ("name", ctypes.c_char_p),
        ("address", ctypes.c_void_p),
    )


def _close_in_order(logger: int) -> None:
    """Have the C layer's clean-up run first at the end of the process, once for each of its libraries.

    The library must stay until then, which it does anyway (it has symbols that forbid unloading).
    """
    process = ctypes.CDLL(None)
    found = _SymbolInfo()
    # The logger begins with the address of its table of virtual functions, which lies in the library.
    table = ctypes.c_void_p.from_address(logger)
    if not process.dladdr(table, ctypes.byref(found)) or found.file in _closed_in_order:
        return
    library = ctypes.CDLL(os.fsdecode(found.file), mode=os.RTLD_NOW | os.RTLD_NOLOAD | os.RTLD_NODELETE)
    finalize = ctypes.cast(library.finalizePythonInterpreter, ctypes.c_void_p)
    process["__cxa_atexit"](finalize, None, None)
    _closed_in_order.add(found.file)
