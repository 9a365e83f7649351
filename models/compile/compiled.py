"""Functions that numba compiles with errors, as of a division by zero, for code that no FMU contains."""

from collections.abc import Callable
from typing import TypeVar

from .kernel import compile_with

F = TypeVar("F", bound=Callable[..., object])


def compiled(function: F) -> F:
    """Compile `function` at its first call, or load what an earlier process compiled."""
    return compile_with(function, {"nopython": True, "boundscheck": None, "no_cfunc_wrapper": True})
