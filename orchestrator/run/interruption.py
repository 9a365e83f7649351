"""Ctrl-C in a command, and SIGTERM: what is kept is told."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager

from models.core.interruption import answer, deferred, is_asked, look


@contextmanager
def tell_interruption(
    describe: Callable[[], str] = lambda: "only compiled code is kept: the same command begins anew",
) -> Iterator[None]:
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
