"""Ctrl-C in a command, and SIGTERM: what is kept is told, and a run ends after its macro step."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager

from models.core.interruption import answer, deferred, is_asked, look
from models.core.quantities import Vector

from ..engine.observer import Observer
from ..engine.step import Step


@contextmanager
def tell_interruption(describe: Callable[[], str]) -> Iterator[None]:
    """Where Ctrl-C ends the block, KeyboardInterrupt says by `describe` what is kept and how to go on."""
    with deferred():
        try:
            yield
            look()
        except (Exception, KeyboardInterrupt) as error:
            interrupted = isinstance(error, KeyboardInterrupt)
            if not (interrupted or is_asked()):
                raise
            answer()
            text = str(error) if interrupted else ""
            raise KeyboardInterrupt(text or f"interrupted; {describe()}") from None


class Interruption(Observer):
    """Raises KeyboardInterrupt after the macro step in which Ctrl-C or SIGTERM came."""

    def observe(self, time: float, outputs: Callable[[], Vector], step: Step) -> None:
        look()
