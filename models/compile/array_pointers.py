"""Pointers to arrays, handed to compiled code in one record.

Each array argument of a compiled function costs time at every call from Python. A function that runs in every
step takes one record with the addresses of all its arrays instead. The arrays must stay where they are.
"""

import ctypes
from functools import cache
from typing import Any

import numba
import numpy as np
from numba import types
from numba.core import cgutils
from numba.extending import intrinsic

from .kernel import COMPILED, kernel

# Records with attributes, which compiled code and plain Python read in the same way.
ARRAY = np.dtype((np.record, [("address", np.int64), ("rows", np.int64), ("columns", np.int64)]))


@cache
def _named(names: tuple[str, ...]) -> Any:
    """An ARRAY for each name. One object for all of these names: numba compares others field by field."""
    return np.dtype((np.record, [(name, ARRAY) for name in names]))


class ArrayPointers:
    """Contiguous arrays of one or two dimensions; `record[0]` has the ARRAY of each, by name."""

    def __init__(self, **arrays: Any) -> None:
        self._arrays = arrays
        self.record = np.zeros(1, dtype=_named(tuple(arrays)))
        for name, array in arrays.items():
            assert array.flags.c_contiguous
            assert not hasattr(np.record, name)  # which plain Python would read instead
            self.record[name] = (array.ctypes.data, *((1, *array.shape)[-2:]))


def _to_pointer(typing: Any, address: Any) -> Any:
    """The address as a pointer that `carray` takes."""

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        return builder.inttoptr(arguments[0], cgutils.voidptr_t)

    return types.voidptr(types.int64), generate


_pointer: Any = intrinsic(_to_pointer) if COMPILED else lambda address: ctypes.c_void_p(int(address))


def _see(dtype: Any) -> tuple[Any, Any]:
    """Kernels that see an array with such elements: as a vector, and in rows."""

    @kernel
    def vector(array: Any) -> Any:
        return numba.carray(_pointer(array.address), array.columns, dtype)

    @kernel
    def table(array: Any) -> Any:
        return numba.carray(_pointer(array.address), (array.rows, array.columns), dtype)

    return vector, table


numbers, table = _see(np.float64)
integers, integer_table = _see(np.int64)
marks, mark_table = _see(np.bool_)
