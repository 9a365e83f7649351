"""Compiled kernels on disk: a file for each content and signature, shared by all that run the same code.

The checkout, an installed package and every FMU, wherever a host unpacks it, find the same files. A file's
name is the digest of what was compiled (`kernel_content`), for which types, by which versions of Python,
numpy, numba and LLVM and for which processor: an edited kernel, and each that calls it, has another name. So
a file is never out of date and never written with two contents. It appears whole or not at all. Every edit
leaves files behind: whoever adds one deletes those that were not used of late, once a day.
"""

import contextlib
import functools
import hashlib
import importlib
import io
import os
import pickle
import sys
import types as python_types
from collections.abc import Callable
from operator import attrgetter
from pathlib import Path
from typing import Any

import llvmlite
import llvmlite.binding as llvm
import numba
import numpy as np
from numba.core import caching, compiler, serialize, sigutils
from numba.core.runtime.nrt import rtsys

from .cache_eviction import due, tidy, use
from .cache_folder import open_folder, user_cache_directory
from .kernel_content import PACKAGE, compute_digest, describe, is_ours, relative_name
from .processor import choose

choose()

# numba's, whose types say little.
types: Any = numba.types
normalized: Any = sigutils.normalize_signature
rebuild: Any = compiler.CompileResult._rebuild
assemble: Any = compiler.compile_result

# The module that compiled kernels say they are from: the same for every copy of this package.
HOME = "tribocosim_kernels"
FOLDER = "kernels"
# A wheel may have compiled kernels beside its packages. FMUs, which have copies of this file, find them by
# the environment.
SHIPPED = "TRIBOCOSIM_KERNELS"
if (_beside := Path(__file__).parents[2] / HOME).is_dir():
    os.environ.setdefault(SHIPPED, str(_beside))
sys.modules.setdefault(HOME, python_types.ModuleType(HOME))

# The layout of files; another writer's are not read.
LAYOUT = 3
# Code (bytes of LLVM's) of which a call takes no noticeable time.
LARGE = 60_000

# Settings of numba's that change the code it makes.
_SETTINGS = ("OPT", "LOOP_VECTORIZE", "SLP_VECTORIZE", "BOUNDSCHECK", "DEBUGINFO_DEFAULT", "USING_SVML")


class KernelCache(caching._Cache):
    """numba's cache of one function; `options` are those that it is compiled with."""

    def __init__(self, function: Callable[..., Any], options: str) -> None:
        self._function, self._options = function, options
        self._files: dict[Any, list[Path]] = {}  # of each signature: for all copies, for this package alone
        self._enabled = True

    @property
    def cache_path(self) -> str:
        """The folder."""
        return str(user_cache_directory() / FOLDER)

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
        rtsys.initialize(target_context)  # what loaded code calls; numba reads its tables to compile only
        # Where numba changed inside, or there is no place to write (nor a home), starting is only slower.
        with contextlib.suppress(AttributeError, TypeError, OSError, RuntimeError):
            key = self._key(sig, target_context.codegen())
            name = self._function.__code__.co_qualname
            self._function.__module__ = HOME
            self._function.__qualname__ = f"{name}_{key[:16]}"
            if self._enabled:
                folder = user_cache_directory() / FOLDER / _versions(target_context.codegen())
                own = hashlib.sha256(f"{key} {PACKAGE}".encode()).hexdigest()
                files = [folder / f"{_plain(name)}-{digest[:32]}.nbc" for digest in (key, own)]
                self._files[sig] = files
                return self._find(files[0], target_context) or self._find(files[1], target_context)
        return None

    def save_overload(self, sig: Any, data: Any) -> None:
        """Keep the compiled code, where there is a place for it."""
        files = self._files.get(sig)
        if files is None or data.library.has_dynamic_globals:
            return
        # The disk may be full or read-only: the code is compiled, only not kept.
        with contextlib.suppress(AttributeError, TypeError, OSError, pickle.PicklingError):
            file = files[self._names_this_package(data)]
            _known[file] = data
            _write(file, self._reduce(data))
            folder = file.parents[1]
            if due(folder / "tidied"):
                tidy(folder.glob("*/*.nbc*"))

    def _key(self, sig: Any, codegen: Any) -> str:
        arguments, result = normalized(sig)
        signature = _digest_type(types.Tuple(arguments)) + (_digest_type(result) if result else "")
        parts = [_versions(codegen), self._options, compute_digest(self._function), signature]
        return hashlib.sha256("\n".join(parts).encode()).hexdigest()

    def _find(self, file: Path, target_context: Any) -> Any:
        """The compiled code in that file, from this process or from disk, or None."""
        known = _known.get(file)
        if known is None:
            kept = _read(file)
            if kept is not None:
                known = _known[file] = self._rebuild(target_context, kept)
            return known
        # With an entry point of its own: numba forgets a function's when the function goes.
        return known._replace(entry_point=self._enter(target_context, known), metadata=None)

    def _enter(self, target_context: Any, known: Any) -> Any:
        """An entry point of the compiled code."""
        return target_context.get_executable(known.library, known.fndesc, known.environment)

    def _names_this_package(self, compiled: Any) -> bool:
        """Whether code imports from this package by name, as a named tuple's class, to give it to Python."""
        return f"{PACKAGE}.".encode() in compiled.library._get_compiled_object()

    def _reduce(self, compiled: Any) -> Any:
        """What of the compiled code a file keeps."""
        # Only people read the annotated source; it is long and slow to make.
        return compiled.library.machine_code, compiled._replace(type_annotation="")._reduce()

    def _rebuild(self, target_context: Any, kept: Any) -> Any:
        """The compiled code, of what a file has kept."""
        machine_code, own = kept
        _load(machine_code, target_context)
        compiled = rebuild(target_context, *own)
        compiled.library.machine_code = machine_code  # callers that are compiled later need it in their files
        return compiled


class Link:
    """In the place of an entry point: by this numba knows code that only kernels call."""


class LinkedKernelCache(KernelCache):
    """The same for code that other kernels link, which has no machine code and no entry for Python."""

    def __init__(self, function: Callable[..., Any], options: str) -> None:
        super().__init__(function, f"{options}, for callers")

    def _enter(self, target_context: Any, known: Any) -> Any:
        return Link()

    def _names_this_package(self, compiled: Any) -> bool:
        return False  # only the entry for Python does

    def _reduce(self, compiled: Any) -> Any:
        compiled.fndesc.typemap = compiled.fndesc.calltypes = None  # numba does the same: some cannot be kept
        library = compiled.library
        bitcode = None if _is_apart(library) else library._get_module_for_linking().as_bitcode()
        return library.name, bitcode, library.machine_code, compiled.fndesc, compiled.signature

    def _rebuild(self, target_context: Any, kept: Any) -> Any:
        name, bitcode, machine_code, fndesc, signature = kept
        _load(machine_code, target_context)
        library = target_context.codegen().create_library(name)
        library.machine_code, library.apart = machine_code, bitcode is None
        if bitcode:
            library._final_module = llvm.parse_bitcode(bitcode)
        library._shared_module, library._finalized = library._final_module, True
        return assemble(
            typing_context=target_context.typing_context,
            target_context=target_context,
            entry_point=Link(),
            library=library,
            fndesc=fndesc,
            signature=signature,
            objectmode=False,
        )


def finalize(library: Any, symbol: str) -> None:
    """As numba does; the function of that symbol has machine code only where it is large.

    The code is optimized before its callers link it: left to them, large mechanisms ran 1.5 times as long.
    """
    library._finalize_final_module = library._finalize_dynamic_globals
    library.finalize()
    del library._finalize_final_module
    library._finalized = True
    if len(library._get_module_for_linking().as_bitcode()) > LARGE:
        library.enable_object_caching()
        library._finalize_final_module()
        library.machine_code[symbol], library.apart = library._get_compiled_object(), True


def keep_apart(library: Any) -> None:
    """Call large kernels instead of linking them: their machine code is made once for all callers.

    Each caller would otherwise translate all below it once more, which takes most of the time of compilation.
    `machine_code` has what is called, by symbol, also through kernels that are linked.
    """
    called = library._linking_libraries
    library._linking_libraries = [one for one in called if not _is_apart(one)]
    library.machine_code = {}
    for one in called:
        library.machine_code.update(getattr(one, "machine_code", {}))  # numba's own have none


def _is_apart(library: Any) -> bool:
    return getattr(library, "apart", False)


def _load(machine_code: dict[str, bytes], target_context: Any) -> None:
    """Have the large kernels in this process, each once."""
    engine = target_context.codegen()._engine
    for symbol, code in machine_code.items():
        if not engine.is_symbol_defined(symbol):
            engine._ee.add_object_file(llvm.ObjectFileRef.from_data(code))
            engine._defined_symbols.add(symbol)


@functools.cache
def _versions(codegen: Any) -> str:
    """A digest of what compiles, and for which processor."""
    settings = [(name, getattr(numba.config, name, None)) for name in _SETTINGS]
    numpy = np.__version__.rpartition(".")[0]  # numba asks for the minor version only
    compilers = (LAYOUT, sys.implementation.cache_tag, numba.__version__, llvmlite.__version__, numpy)
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


# What this process has compiled or loaded: numba never gives its memory back, so that loading it once more
# for the next closure of the same content would only take more.
_known: dict[Path, Any] = {}


def _read(file: Path) -> Any:
    """What `_write` wrote, or a wheel has; None if the file is missing, damaged or names modules not here."""
    for read in (_read_shipped, _read_cached):
        content = read(file)
        check, payload = content[:32], content[32:]
        if hashlib.sha256(payload).digest() == check:
            with contextlib.suppress(ImportError, AttributeError):
                return _Unpickler(io.BytesIO(payload)).load()
    return None


def _read_shipped(file: Path) -> bytes:
    """The content of the file of that name in the wheel, trusted as its code is; empty if there is none."""
    with contextlib.suppress(OSError):
        if shipped := os.environ.get(SHIPPED):
            return Path(shipped, file.parent.name, file.name).read_bytes()
    return b""


def _read_cached(file: Path) -> bytes:
    use(file)
    with contextlib.suppress(FileNotFoundError), open_folder(f"{FOLDER}/{file.parent.name}") as folder:
        return folder.read(file.name)
    return b""


def _write(file: Path, kept: Any) -> None:
    stream = io.BytesIO()
    pickler: Any = _Pickler
    pickler(stream, protocol=4).dump(kept)
    payload = stream.getvalue()
    with open_folder(f"{FOLDER}/{file.parent.name}") as folder:
        folder.write(file.name, hashlib.sha256(payload).digest() + payload)


class _Pickler(serialize.NumbaPickler):
    """Names classes of this package by their place in it, so that every copy of it loads its own."""

    def persistent_id(self, value: Any) -> str | None:
        return relative_name(value) if isinstance(value, type) and is_ours(value) else None


class _Unpickler(pickle.Unpickler):
    def persistent_load(self, name: str) -> Any:
        module, _, cls = name.partition(":")
        return attrgetter(cls)(importlib.import_module(PACKAGE + module))
