"""Notice when kernels are compiled: the time counts for no participant, and the user is told."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager

from numba.core import event

# What numba tells of: compiling, and all that comes before a kernel's first call, loading from disk too.
COMPILING, PREPARING = "numba:compile", "numba:compiler_lock"


class _Noticing(event.Listener):
    """Calls `begin` and `end` around compilations; kernels that are compiled for others count as one."""

    def __init__(self, begin: Callable[[], None], end: Callable[[], None]) -> None:
        self._begin, self._end = begin, end
        self._depth = 0

    def on_start(self, event: object) -> None:
        self._depth += 1
        if self._depth == 1:
            self._begin()

    def on_end(self, event: object) -> None:
        self._depth -= 1
        if self._depth == 0:
            self._end()


@contextmanager
def announce_compilation(
    what: str, begin: Callable[[], None], end: Callable[[], None] = lambda: None
) -> Iterator[None]:
    """Within the block, `begin` is called when this process begins `what`, and `end` when it has ended."""
    with event.install_listener(what, _Noticing(begin, end)):
        yield
