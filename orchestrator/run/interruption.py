"""Ctrl-C in a command: what is kept is told, and a run ends after its macro step."""

import signal
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import FrameType, TracebackType
from typing import Any, Self

from models.core.quantities import Vector

from ..engine.observer import Observer
from ..engine.step import Step


class Noticed:
    """Remembers that Ctrl-C came; it is raised as ever.

    Libraries make other errors of it: numba, broken off while it compiles, one about its half-made code.
    Outside the main thread, which alone gets signals, and in a command that was started without Ctrl-C it
    does nothing.
    """

    def __init__(self) -> None:
        self.asked = False
        self._previous: Any = None

    def __enter__(self) -> Self:
        if threading.current_thread() is threading.main_thread():
            self._previous = signal.getsignal(signal.SIGINT)
            if callable(self._previous):
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


@contextmanager
def tell_interruption(describe: Callable[[], str]) -> Iterator[None]:
    """Where Ctrl-C ends the block, KeyboardInterrupt says by `describe` what is kept and how to go on."""
    with Noticed() as noticed:
        try:
            yield
        except (Exception, KeyboardInterrupt) as error:
            interrupted = isinstance(error, KeyboardInterrupt)
            if not (interrupted or noticed.asked):
                raise
            text = str(error) if interrupted else ""
            raise KeyboardInterrupt(text or f"interrupted; {describe()}") from None


class Interruption(Noticed, Observer):
    """Raises KeyboardInterrupt after the macro step in which Ctrl-C came.

    Raised inside a Python FMU, it would come back as that FMU's error. A second Ctrl-C is raised at once.
    """

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        super().__exit__(kind, error, trace)
        if self.asked and kind is None:  # it came in the last step
            raise KeyboardInterrupt

    def _notice(self, number: int, frame: FrameType | None) -> None:
        if self.asked:
            raise KeyboardInterrupt
        self.asked = True

    def observe(self, time: float, outputs: Callable[[], Vector], step: Step) -> None:
        if self.asked:
            raise KeyboardInterrupt
