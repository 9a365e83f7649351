"""Notice when kernels are compiled: the user is told."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager

from numba.core import event


class _Noticing(event.Listener):
    """Calls `begin` before compilations; kernels that are compiled for others count as one."""

    def __init__(self, begin: Callable[[], None]) -> None:
        self._begin = begin
        self._depth = 0

    def on_start(self, event: object) -> None:
        self._depth += 1
        if self._depth == 1:
            self._begin()

    def on_end(self, event: object) -> None:
        self._depth -= 1


@contextmanager
def announce_compilation(begin: Callable[[], None]) -> Iterator[None]:
    """Within the block, `begin` is called whenever this process begins to compile."""
    with event.install_listener("numba:compile", _Noticing(begin)):
        yield
