"""What a kernel computes, as a digest: of its code and of all that it refers to, wherever its file lies.

Two kernels with the same digest are the same code over the same constants and the same callees, whether they
come from the repository, an installed package or an unpacked FMU. Comments, line numbers and the names of
files and of this package are no part of it.
"""

import dis
import functools
import hashlib
import sys
import types
import weakref
from collections.abc import Callable
from typing import Any

import numpy as np

# The package that this file is in, whatever its name here.
PACKAGE = __name__.rsplit(".", 2)[0]

# Modules that a version number describes.
_FIXED = {"builtins", "numpy", "numba", "llvmlite", *sys.stdlib_module_names}

# The digest that each function had when it was first looked at: what it refers to may be bound anew, and
# compiled code keeps what it was compiled with.
_first: weakref.WeakKeyDictionary[Callable[..., Any], str] = weakref.WeakKeyDictionary()


def compute_digest(function: Callable[..., Any]) -> str:
    """The digest of a Python function that numba compiles (64 hexadecimal digits), equal in every process.

    TypeError if it refers to what has no such description, or to what changed since it was first looked at.
    """
    return _digest_function(function, {})


def describe(value: Any) -> str:
    """A description, equal in every process, of a constant that a kernel refers to; TypeError without one."""
    return _digest_value(value, {})


def relative_name(cls: type) -> str:
    """Where a class is found, without the name of this package."""
    module = cls.__module__
    return f"{module[len(PACKAGE) :] if is_ours(cls) else module}:{cls.__qualname__}"


def is_ours(cls: type) -> bool:
    """Whether a class belongs to this package."""
    return cls.__module__.startswith(f"{PACKAGE}.")


def _digest_function(function: Any, seen: dict[Any, str]) -> str:
    if function in seen:
        return seen[function]
    code, names, attributes = _digest_code(function.__code__)
    seen[function] = f"itself:{code}"  # in a recursion
    cells = [_digest_value(cell.cell_contents, seen) for cell in function.__closure__ or ()]
    used = [f"{name}={_digest_global(function.__globals__, name, attributes, seen)}" for name in names]
    defaults = _digest_value((function.__defaults__, function.__kwdefaults__), seen)
    found = hashlib.sha256("\n".join([code, defaults, *cells, "", *used]).encode()).hexdigest()
    if _first.setdefault(function, found) != found:
        raise TypeError(f"{function!r} refers to what was changed")
    seen[function] = found
    return found


@functools.cache
def _digest_code(code: types.CodeType) -> tuple[str, tuple[str, ...], tuple[str, ...]]:
    """A digest of the code object, the global names that it uses, and all names that may be attributes of
    theirs, with those of functions within."""
    names = {i.argval for i in dis.get_instructions(code) if i.opname in ("LOAD_GLOBAL", "LOAD_NAME")}
    attributes = set(code.co_names)
    constants = []
    for constant in code.co_consts:
        if isinstance(constant, types.CodeType):
            inner, inner_names, inner_attributes = _digest_code(constant)
            constants.append(inner)
            names.update(inner_names)
            attributes.update(inner_attributes)
        else:
            constants.append(_digest_value(constant, {}))
    facts = (
        code.co_qualname, code.co_code.hex(), code.co_exceptiontable.hex(), constants, code.co_names,
        code.co_varnames, code.co_freevars, code.co_cellvars, code.co_flags, code.co_argcount,
        code.co_posonlyargcount, code.co_kwonlyargcount,
    )  # fmt: skip
    digest = hashlib.sha256(repr(facts).encode()).hexdigest()
    return digest, tuple(sorted(names)), tuple(sorted(attributes))


def _digest_global(
    found: dict[str, Any], name: str, attributes: tuple[str, ...], seen: dict[Any, str]
) -> str:
    if name not in found:
        return "builtin"
    value = found[name]
    if isinstance(value, types.ModuleType) and not _is_fixed(value.__name__):
        used = [inner for inner in attributes if inner in value.__dict__]
        inside = (f"{inner}={_digest_global(value.__dict__, inner, attributes, seen)}" for inner in used)
        return f"module {{{','.join(inside)}}}"
    return _digest_value(value, seen)


def _digest_value(value: Any, seen: dict[Any, str]) -> str:
    if value is None or value is Ellipsis or isinstance(value, (bool, int, float, complex, str, bytes)):
        return f"{type(value).__name__} {value!r}"
    if type(value) is tuple:
        return "(" + ",".join(_digest_value(item, seen) for item in value) + ")"
    if isinstance(value, tuple) and hasattr(value, "_fields"):
        return f"{_digest_foreign(type(value), seen)} {_digest_value(tuple(value), seen)}"
    if isinstance(value, dict):
        return "{" + ",".join(f"{key!r}:{_digest_value(value[key], seen)}" for key in sorted(value)) + "}"
    if isinstance(value, frozenset):
        return "{" + ",".join(sorted(_digest_value(item, seen) for item in value)) + "}"
    if isinstance(value, np.generic):
        return f"{value.dtype.str} {value!r}"
    if isinstance(value, np.dtype):
        return f"dtype {value!r}"
    if isinstance(value, np.ndarray) and value.dtype.kind in "biufc":
        return f"array {value.dtype.str} {value.shape} {value.tobytes().hex()}"
    if isinstance(value, types.ModuleType) and _is_fixed(value.__name__):
        return f"module {value.__name__}"
    if isinstance(value, (type, types.BuiltinFunctionType, np.ufunc)):
        return _digest_foreign(value, seen)
    if isinstance(symbol := getattr(value, "symbol", None), str) and _is_fixed(type(value).__module__):
        return f"{symbol} {value.sig!r}"  # a function of C
    # A kernel, an intrinsic of numba's, or what one calls.
    function = getattr(value, "py_func", None) or getattr(value, "_defn", None) or value
    if isinstance(function, types.FunctionType):
        return f"{type(value).__name__} {_digest_function(function, seen)}"
    raise TypeError(f"{value!r} has no description that is equal in every process")


def _digest_foreign(value: Any, seen: dict[Any, str]) -> str:
    """A function or class of Python's or numpy's, or a named tuple."""
    if isinstance(value, type) and issubclass(value, tuple) and hasattr(value, "_fields"):
        defaults = _digest_value(value._field_defaults, seen)  # type: ignore[attr-defined]
        return f"named tuple {relative_name(value)} {value._fields} {defaults}"
    module = getattr(value, "__module__", None) or "numpy"  # of its ufuncs
    if not _is_fixed(module):
        raise TypeError(f"{value!r} has no description that is equal in every process")
    return f"{module}:{getattr(value, '__qualname__', value.__name__)}"


def _is_fixed(module: str) -> bool:
    return module.partition(".")[0] in _FIXED
