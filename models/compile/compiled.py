"""Functions that numba compiles and keeps in its own cache."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar, cast

import numba
from numba.core import caching
from numba.core.runtime.nrt import rtsys

F = TypeVar("F", bound=Callable[..., Any])


class _Cache(caching.FunctionCache):
    def load_overload(self, sig: Any, target_context: Any) -> Any:
        """As numba does, which first reads the tables of all that it can compile: a third of a second."""
        guard: Any = self._guard_against_spurious_io_errors
        start: Any = rtsys.initialize
        start(target_context)
        with guard():
            return self._load_overload(sig, target_context)  # type: ignore[no-untyped-call]


def compiled(function: F) -> F:
    """Compile `function` at its first call, or load what an earlier process compiled."""
    dispatcher: Any = numba.njit(function)
    if not numba.config.DISABLE_JIT:  # type: ignore[attr-defined]
        dispatcher._cache = _Cache(function)  # type: ignore[no-untyped-call]
    return cast(F, dispatcher)
