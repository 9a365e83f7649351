"""Ctrl-C in a command, and SIGTERM: what is kept is told, and a run ends after its macro step."""

import signal
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import FrameType, TracebackType
from typing import Any, Self

from models.core.quantities import Vector

from ..engine.observer import Observer
from ..engine.step import Step

# The signals that were noticed, in their order.
came: list[int] = []


class Noticed:
    """Remembers that Ctrl-C came, or SIGTERM where that has a handler; it is raised as ever.

    Libraries make other errors of it: numba, broken off while it compiles, one about its half-made code.
    Outside the main thread, which alone gets signals, and in a command that was started without Ctrl-C it
    does nothing.
    """

    def __init__(self) -> None:
        self.asked = False
        self._previous: dict[int, Any] = {}

    def __enter__(self) -> Self:
        if threading.current_thread() is threading.main_thread():
            handlers = {number: signal.getsignal(number) for number in (signal.SIGINT, signal.SIGTERM)}
            self._previous = {number: handler for number, handler in handlers.items() if callable(handler)}
            for number in self._previous:
                signal.signal(number, self._notice)
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        for number, handler in self._previous.items():
            signal.signal(number, handler)

    def _notice(self, number: int, frame: FrameType | None) -> None:
        self.asked = True
        came.append(number)
        self._previous[number](number, frame)


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
    """Raises KeyboardInterrupt after the macro step in which Ctrl-C or SIGTERM came.

    Raised inside a Python FMU, it would come back as that FMU's error. A second Ctrl-C is raised at once.
    """

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        super().__exit__(kind, error, trace)
        if self.asked and kind is None:  # it came in the last step
            raise KeyboardInterrupt

    def _notice(self, number: int, frame: FrameType | None) -> None:
        came.append(number)
        if self.asked:
            raise KeyboardInterrupt
        self.asked = True

    def observe(self, time: float, outputs: Callable[[], Vector], step: Step) -> None:
        if self.asked:
            raise KeyboardInterrupt
