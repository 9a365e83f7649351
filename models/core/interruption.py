"""Ctrl-C and SIGTERM are noted when they come, and raised where the program looks for them.

Raised at once, KeyboardInterrupt is lost in a callback (of a compiler, a weak reference, a destructor),
leaves half-made objects of a library, and comes back from a Python FMU as that FMU's error.
"""

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType

# The signals since the outermost block began, and those of them that nobody has answered.
came: list[int] = []
_waiting: list[int] = []
_at_once: list[bool] = []  # one for each block


@contextmanager
def deferred() -> Iterator[None]:
    """In the block `look` raises the first Ctrl-C or SIGTERM; the next one is raised at once.

    Outside the main thread, which alone gets signals, and for a signal without a Python handler, as Ctrl-C in
    the background of a shell, it does nothing.
    """
    before, outermost = {}, False
    if threading.current_thread() is threading.main_thread():
        handlers = {number: signal.getsignal(number) for number in (signal.SIGINT, signal.SIGTERM)}
        before = {n: handler for n, handler in handlers.items() if callable(handler) and handler != _note}
        outermost = _note not in handlers.values()
        for number in before:
            signal.signal(number, _note)
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
        if outermost:
            came.clear()
            _waiting.clear()


@contextmanager
def at_once() -> Iterator[None]:
    """In the block of a `deferred` one the first signal, too, is raised when it comes: where a call may never
    return, and nothing that it does is kept."""
    look()
    _at_once.append(True)
    try:
        yield
    finally:
        _at_once.pop()


def _note(number: int, frame: FrameType | None) -> None:
    came.append(number)
    _waiting.append(number)
    if len(_waiting) > 1 or _at_once:
        raise KeyboardInterrupt


def is_asked() -> bool:
    """Whether a signal came that is not answered."""
    return bool(_waiting)


def look() -> None:
    """KeyboardInterrupt if a signal came that is not answered: again wherever a library swallows it."""
    if _waiting:
        raise KeyboardInterrupt


def answer() -> None:
    """The interruption has ended what it was to end."""
    _waiting.clear()
