"""Compilation of kernels: numba where it is installed, the plain function where it is not.

Kernels are pure functions of floats, float arrays and records that allocate nothing and raise nothing.
Compiled code is kept on disk under the digest of this package's source, so that it is reused by every
process (and every FMU, wherever a host unpacks it) that runs the same source, and by no other.
"""

from __future__ import annotations

import contextlib
import functools
import hashlib
import os
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar, cast

import numpy as np

numba: Any
caching: Any
try:
    import numba
    import numba.extending
    from numba.core import caching
except ImportError:  # an FMU must run where only numpy is installed
    numba = None

COMPILED = numba is not None and not os.environ.get("NUMBA_DISABLE_JIT", "0").strip("0")

F = TypeVar("F", bound=Callable[..., Any])


def kernel(function: F) -> F:
    """Compile `function` at its first call; without numba, return it unchanged.

    Division by zero gives inf or nan (as in numpy), so that kernels cannot raise. They release the
    interpreter, so that threads run them side by side.
    """
    if not COMPILED:
        return function
    if function.__closure__:
        _name_by_content(function)
    dispatcher: Any = numba.njit(
        error_model="numpy",
        nogil=True,
        no_cfunc_wrapper=True,  # only kernels that are passed as values would need one
    )(function)
    # Where numba changed inside, or there is no place to write (nor a home), starting is only slower.
    with contextlib.suppress(AttributeError, TypeError, OSError, RuntimeError):
        dispatcher._cache = _DigestCache(function)
    return cast(F, dispatcher)


def _name_by_content(function: Callable[..., Any]) -> None:
    """Make a closure's name say what it captured.

    numba's symbols are made of module, name and a number that counts functions in the process that
    compiled them. Two closures of one function, compiled in different processes and loaded from disk into
    a third, could bear the same symbol, and one would run as the other.
    """
    with contextlib.suppress(TypeError):
        content = hashlib.sha256(closure_of(function).encode()).hexdigest()[:16]
        function.__qualname__ = f"{function.__qualname__}_{content}"


@functools.cache
def source_digest() -> str:
    """SHA-256 over the Python files of this package, in the order of their names (first 16 digits)."""
    root = Path(__file__).parent
    digest = hashlib.sha256()
    for file in sorted(root.rglob("*.py")):
        digest.update(file.relative_to(root).as_posix().encode())
        digest.update(file.read_bytes())
    return digest.hexdigest()[:16]


def user_cache_directory() -> Path:
    """Where this user's derived files go: $TRIBOCOSIM_CACHE or the platform's cache folder."""
    if chosen := os.environ.get("TRIBOCOSIM_CACHE"):
        return Path(chosen)
    if sys.platform == "win32":
        return Path(os.environ.get("LOCALAPPDATA", Path.home() / "AppData" / "Local")) / "tribocosim"
    if sys.platform == "darwin":
        return Path.home() / "Library" / "Caches" / "tribocosim"
    return Path(os.environ.get("XDG_CACHE_HOME", Path.home() / ".cache")) / "tribocosim"


def _describe(value: Any) -> str:
    """A description of what a closure captured that is equal in every process, or TypeError."""
    if isinstance(value, (bool, int, float, str, type(None))):
        return repr(value)
    if isinstance(value, tuple):
        return "(" + ",".join(_describe(item) for item in value) + ")"
    if isinstance(value, np.dtype):
        return repr(value)
    function = getattr(value, "py_func", None)
    if function is None:
        raise TypeError(f"cannot describe {value!r}")
    cells = function.__closure__ or ()
    inner = ",".join(_describe(cell.cell_contents) for cell in cells)
    return f"{function.__module__}:{function.__qualname__}:{function.__code__.co_firstlineno}[{inner}]"


def _record_of(context: Any, vector: Any, dtype: Any) -> Any:
    """The record of that type which shares the vector's memory.

    As `vector.view(dtype)[0]`, without its checks of what layouts make sure of, which numba compiles at
    every call.
    """

    def address(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        array = context.make_array(signature.args[0])(context, builder, arguments[0])
        return builder.bitcast(array.data, context.get_value_type(signature.return_type))

    return dtype.dtype(vector, dtype), address


# record_of(vector, dtype), in kernels only.
record_of: Any = (
    numba.extending.intrinsic(_record_of) if COMPILED else lambda vector, dtype: vector.view(dtype)[0]
)


if COMPILED:

    class _Locator:
        """The place of a function's compiled code: cache folder / digest of the source / module."""

        def __init__(self, function: Callable[..., Any]) -> None:
            self._py_file = function.__code__.co_filename
            folder = user_cache_directory() / "kernels" / source_digest() / function.__module__
            self._path = str(folder)

        def get_cache_path(self) -> str:
            return self._path

        def get_source_stamp(self) -> str:
            return source_digest()

        def ensure_cache_path(self) -> None:
            os.makedirs(self._path, exist_ok=True)

    class _DigestCacheImpl(caching.CompileResultCacheImpl):  # type: ignore[misc]
        def __init__(self, function: Callable[..., Any]) -> None:
            self._lineno = function.__code__.co_firstlineno
            self._locator = _Locator(function)
            self._locator.ensure_cache_path()
            self._function = function

        @property
        def filename_base(self) -> str:
            # One file per closure: numba's index is not safe against two processes adding different
            # closures of one function at the same time.
            version = f"{sys.implementation.cache_tag}-{numba.__version__}"
            name = f"{self._function.__qualname__}:{self._lineno}:{closure_of(self._function)}"
            return hashlib.sha256(f"{name}:{version}".encode()).hexdigest()[:24]

    class _DigestCache(caching.FunctionCache):  # type: ignore[misc]
        """numba's function cache, keyed by source digest and captured values instead of file times."""

        _impl_class = _DigestCacheImpl

        def save_overload(self, sig: Any, data: Any) -> None:
            # The folder was there, but the disk is full or read-only: the code is compiled, only not kept.
            with contextlib.suppress(OSError):
                super().save_overload(sig, data)

        def _index_key(self, sig: Any, codegen: Any) -> Any:
            return sig, codegen.magic_tuple(), closure_of(self._py_func)


def closure_of(function: Callable[..., Any]) -> str:
    """A description, equal in every process, of what `function` captured; TypeError if there is none."""
    return ",".join(_describe(cell.cell_contents) for cell in function.__closure__ or ())
