"""Notice when kernels are compiled: the user is told."""

import time as clock
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from numba.core import event


class _Noticing(event.Listener):
    """Calls `begin` before compilations, and `end(seconds)` after them; kernels that are compiled for others
    count as one. `each` is called before each of them."""

    def __init__(
        self, begin: Callable[[], None], end: Callable[[float], None], each: Callable[[], None]
    ) -> None:
        self._begin, self._end, self._each = begin, end, each
        self._depth, self._begun = 0, 0.0

    def on_start(self, event: object) -> None:
        self._each()
        self._depth += 1
        if self._depth == 1:
            self._begun = clock.perf_counter()
            self._begin()

    def on_end(self, event: object) -> None:
        self._depth -= 1
        if not self._depth:
            self._end(clock.perf_counter() - self._begun)


@contextmanager
def announce_compilation(
    begin: Callable[[], None], end: Callable[[float], None], each: Callable[[], None] = lambda: None
) -> Iterator[None]:
    """Within the block, `begin` is called whenever this process begins to compile, `end` with its time, and
    `each` for every kernel."""
    with event.install_listener("numba:compile", _Noticing(begin, end, each)):
        yield
