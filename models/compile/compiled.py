"""Functions that numba compiles as it does by default, for code that is never part of an FMU."""

from collections.abc import Callable
from typing import Any, TypeVar, cast

import numba

from .kernel_cache import KernelCache

F = TypeVar("F", bound=Callable[..., Any])


def compiled(function: F) -> F:
    """Compile `function` at its first call, or load what an earlier process compiled."""
    dispatcher: Any = numba.njit(function)
    if not numba.config.DISABLE_JIT:  # type: ignore[attr-defined]
        dispatcher._cache = KernelCache(function, "with errors")
    return cast(F, dispatcher)
