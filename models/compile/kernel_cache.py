"""Compiled kernels on disk: a file for each content and signature, shared by all that run the same code.

The checkout, an installed package and every FMU, wherever a host unpacks it, find the same files. A file's
name is the digest of what was compiled (`kernel_content`), for which types, by which versions of Python,
numpy, numba and LLVM and for which processor: an edited kernel, and each that calls it, has another name. So
a file is never out of date and never written with two contents. It appears whole or not at all. Every edit
leaves files behind: whoever adds one deletes those that were not used of late, once a day.
"""

from __future__ import annotations

import contextlib
import functools
import hashlib
import importlib
import io
import pickle
import sys
import types as python_types
import uuid
from collections.abc import Callable
from operator import attrgetter
from pathlib import Path
from typing import Any

import llvmlite
import numba
import numpy as np
from numba.core import caching, compiler, serialize, sigutils

from .cache_eviction import due, tidy, use
from .kernel_content import PACKAGE, compute_digest, describe, is_ours, relative_name

# numba's, whose types say little.
types: Any = numba.types
normalized: Any = sigutils.normalize_signature
rebuild: Any = compiler.CompileResult._rebuild

# The module that compiled kernels say they are from: the same for every copy of this package.
HOME = "tribocosim_kernels"
sys.modules.setdefault(HOME, python_types.ModuleType(HOME))

# Settings of numba's that change the code it makes.
_SETTINGS = ("OPT", "LOOP_VECTORIZE", "SLP_VECTORIZE", "BOUNDSCHECK", "DEBUGINFO_DEFAULT", "USING_SVML")


class KernelCache(caching._Cache):
    """numba's cache of one function, in `folder`; `options` are those that it is compiled with."""

    def __init__(self, function: Callable[..., Any], folder: Callable[[], Path], options: str) -> None:
        self._function, self._folder, self._options = function, folder, options
        self._files: dict[Any, list[Path]] = {}  # of each signature: for all copies, for this package alone
        self._enabled = True

    @property
    def cache_path(self) -> str:
        """The folder."""
        return str(self._folder())

    def enable(self) -> None:
        """Read and write files."""
        self._enabled = True

    def disable(self) -> None:
        """Neither read nor write files."""
        self._enabled = False

    def flush(self) -> None:
        """Nothing to do: no file is ever out of date."""

    def load_overload(self, sig: Any, target_context: Any) -> Any:
        """The compiled code for a signature, or None; also names what is going to be compiled.

        numba's symbols are made of module, name, types and numbers that count functions and types in the
        process that compiled them. Two functions compiled in different processes and loaded into a third
        could bear the same symbol, and one would run as the other: the name has to tell them apart.
        """
        target_context.refresh()
        # Where numba changed inside, or there is no place to write (nor a home), starting is only slower.
        with contextlib.suppress(AttributeError, TypeError, OSError, RuntimeError):
            key = self._key(sig, target_context.codegen())
            name = self._function.__code__.co_qualname
            self._function.__module__ = HOME
            self._function.__qualname__ = f"{name}_{key[:16]}"
            if self._enabled:
                folder = self._folder() / _versions(target_context.codegen())
                own = hashlib.sha256(f"{key} {PACKAGE}".encode()).hexdigest()
                files = [folder / f"{_plain(name)}-{digest[:32]}.nbc" for digest in (key, own)]
                self._files[sig] = files
                return _find(files[0], target_context) or _find(files[1], target_context)
        return None

    def save_overload(self, sig: Any, data: Any) -> None:
        """Keep the compiled code, where there is a place for it."""
        files = self._files.get(sig)
        if files is None or data.library.has_dynamic_globals:
            return
        # The disk may be full or read-only: the code is compiled, only not kept.
        with contextlib.suppress(AttributeError, TypeError, OSError, pickle.PicklingError):
            file = files[_names_this_package(data)]
            _known[file] = data
            _write(file, data)
            if due(self._folder() / "tidied"):
                tidy(self._folder().glob("*/*.nbc*"))

    def _key(self, sig: Any, codegen: Any) -> str:
        arguments, result = normalized(sig)
        signature = _digest_type(types.Tuple(arguments)) + (_digest_type(result) if result else "")
        parts = [_versions(codegen), self._options, compute_digest(self._function), signature]
        return hashlib.sha256("\n".join(parts).encode()).hexdigest()


@functools.cache
def _versions(codegen: Any) -> str:
    """A digest of what compiles, and for which processor."""
    settings = [(name, getattr(numba.config, name, None)) for name in _SETTINGS]
    compilers = (sys.implementation.cache_tag, numba.__version__, llvmlite.__version__, np.__version__)
    return hashlib.sha256(repr((compilers, settings, codegen.magic_tuple())).encode()).hexdigest()[:16]


def _digest_type(value: Any) -> str:
    """A description, equal in every process, of one of numba's types; TypeError without one."""
    if isinstance(value, types.BaseTuple):
        cls = getattr(value, "instance_class", None)
        items = ",".join(_digest_type(item) for item in value)
        return f"{describe(cls) if cls else ''}({items})"
    if isinstance(value, types.Dispatcher):
        return f"kernel {compute_digest(value.dispatcher.py_func)}"
    if isinstance(value, types.Omitted):
        return f"omitted {describe(value.value)}"
    if isinstance(value, types.Array):
        _digest_type(value.dtype)
        return repr(value)
    if isinstance(value, (types.Number, types.Boolean, types.NoneType, types.Record, types.Literal)):
        return repr(value)
    raise TypeError(f"{value!r} has no description that is equal in every process")


def _plain(name: str) -> str:
    """The last part of a name, as a part of a file's."""
    return "".join(letter for letter in name.rpartition(".")[2] if letter.isalnum() or letter == "_")


def _names_this_package(compiled: Any) -> bool:
    """Whether code imports from this package by name: to give Python a named tuple, it imports its class."""
    return f"{PACKAGE}.".encode() in compiled.library._get_compiled_object()


# What this process has compiled or loaded: numba never gives its memory back, so that loading it once more
# for the next closure of the same content would only take more.
_known: dict[Path, Any] = {}


def _find(file: Path, target_context: Any) -> Any:
    """The compiled code in that file, from this process or from disk, or None."""
    known = _known.get(file)
    if known is None:
        known = _read(file, target_context)
        if known is not None:
            _known[file] = known
        return known
    # With an entry point of its own: numba forgets a function's when the function goes.
    entry = target_context.get_executable(known.library, known.fndesc, known.environment)
    return known._replace(entry_point=entry, metadata=None)


def _read(file: Path, target_context: Any) -> Any:
    """The code that `_write` wrote; None if the file is missing or damaged."""
    use(file)
    try:
        content = file.read_bytes()
    except FileNotFoundError:
        return None
    check, payload = content[:32], content[32:]
    if hashlib.sha256(payload).digest() != check:
        return None
    return rebuild(target_context, *_Unpickler(io.BytesIO(payload)).load())


def _write(file: Path, compiled: Any) -> None:
    stream = io.BytesIO()
    # Only people read the annotated source; it is long and slow to make.
    pickler: Any = _Pickler
    pickler(stream, protocol=4).dump(compiled._replace(type_annotation="")._reduce())
    payload = stream.getvalue()
    file.parent.mkdir(parents=True, exist_ok=True)
    new = file.with_name(f"{file.name}.{uuid.uuid4().hex[:16]}")
    try:
        new.write_bytes(hashlib.sha256(payload).digest() + payload)
        new.replace(file)
    except OSError:
        new.unlink(missing_ok=True)
        raise


class _Pickler(serialize.NumbaPickler):
    """Names classes of this package by their place in it, so that every copy of it loads its own."""

    def persistent_id(self, value: Any) -> str | None:
        return relative_name(value) if isinstance(value, type) and is_ours(value) else None


class _Unpickler(pickle.Unpickler):
    def persistent_load(self, name: str) -> Any:
        module, _, cls = name.partition(":")
        return attrgetter(cls)(importlib.import_module(PACKAGE + module))
