"""Arrays for compiled code by their addresses.

A call from Python of compiled code takes time for every array it is handed. What runs in every step is
handed one record with the addresses of all arrays that it works on, made once: they have to stay in place.
"""

from __future__ import annotations

import ctypes
from functools import cache
from typing import Any

import numba
import numpy as np
from numba import types
from numba.core import cgutils
from numba.extending import intrinsic

# Records with attributes, which compiled code and plain Python read in the same way.
ARRAY = np.dtype((np.record, [("address", np.int64), ("rows", np.int64), ("columns", np.int64)]))


@cache
def _named(names: tuple[str, ...]) -> Any:
    """An ARRAY for each name. One object for all of these names: numba compares others field by field."""
    return np.dtype((np.record, [(name, ARRAY) for name in names]))


class Addressed:
    """Keeps contiguous arrays of one or two dimensions; `record[0]` has an ARRAY for each, by name."""

    def __init__(self, **arrays: Any) -> None:
        self._arrays = arrays
        self.record = np.zeros(1, dtype=_named(tuple(arrays)))
        for name, array in arrays.items():
            assert array.flags.c_contiguous
            assert not hasattr(np.record, name)  # which plain Python would read instead
            self.record[name] = (array.ctypes.data, *((1, *array.shape)[-2:]))


@intrinsic
def _pointer(typing: Any, address: Any) -> Any:
    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        return builder.inttoptr(arguments[0], cgutils.voidptr_t)

    return types.voidptr(types.int64), generate


if numba.config.DISABLE_JIT:

    def _pointer(address: Any) -> Any:  # as `carray` takes it in plain Python
        return ctypes.c_void_p(int(address))


@numba.njit(cache=True)
def numbers(array: Any) -> Any:
    """A vector of floating-point numbers."""
    return numba.carray(_pointer(array.address), array.columns, np.float64)


@numba.njit(cache=True)
def table(array: Any) -> Any:
    """Rows of floating-point numbers."""
    return numba.carray(_pointer(array.address), (array.rows, array.columns), np.float64)


@numba.njit(cache=True)
def integers(array: Any) -> Any:
    """A vector of whole numbers."""
    return numba.carray(_pointer(array.address), array.columns, np.int64)


@numba.njit(cache=True)
def integer_table(array: Any) -> Any:
    """Rows of whole numbers."""
    return numba.carray(_pointer(array.address), (array.rows, array.columns), np.int64)


@numba.njit(cache=True)
def marks(array: Any) -> Any:
    """A vector of truth values."""
    return numba.carray(_pointer(array.address), array.columns, np.bool_)


@numba.njit(cache=True)
def mark_table(array: Any) -> Any:
    """Rows of truth values."""
    return numba.carray(_pointer(array.address), (array.rows, array.columns), np.bool_)
