"""Compilation of kernels: numba where it is installed, the plain function where it is not.

Kernels are pure functions of floats, float arrays and records that allocate nothing and raise nothing.
Compiled code is kept on disk under the digest of what it was made of (`kernel_cache`), so that it is reused
by every process (and every FMU, wherever a host unpacks it) that runs the same code, and by no other.
"""

import contextlib
import os
from collections.abc import Callable
from typing import Any, TypeVar, cast

import numpy as np

numba: Any
KernelDispatcher: Any = None
try:
    import numba
    import numba.extending
except ImportError:  # an FMU must run where only numpy is installed
    numba = None

COMPILED = numba is not None and not os.environ.get("NUMBA_DISABLE_JIT", "0").strip("0")

if COMPILED:
    # Where numba changed inside, starting is only slower.
    with contextlib.suppress(AttributeError, ImportError):
        from .kernel_dispatcher import KernelDispatcher

_OPTIONS = {
    "nopython": True,
    "boundscheck": None,
    "error_model": "numpy",
    "nogil": True,
    "no_cfunc_wrapper": True,  # only kernels that are passed as values would need one
}

F = TypeVar("F", bound=Callable[..., Any])


def kernel(function: F) -> F:
    """Compile `function` at its first call; without numba, return it unchanged.

    Division by zero gives inf or nan (as in numpy), so that kernels cannot raise. They release the
    interpreter, so that threads run them side by side.
    """
    return compile_with(function, _OPTIONS)


def inlined(function: F) -> F:
    """As `kernel`, made part of each kernel that calls it: records of many arrays are costly to pass."""
    return compile_with(function, {**_OPTIONS, "forceinline": True})


def uncounted(function: F) -> F:
    """As `kernel`, for one that returns no array: it counts no references to those it looks into."""
    return compile_with(function, {**_OPTIONS, "_nrt": False})


def compile_with(function: F, options: dict[str, Any]) -> F:
    """As `kernel`, with these options of numba's."""
    if not COMPILED:
        return function
    dispatcher: Any = (
        KernelDispatcher(function, targetoptions=options)
        if KernelDispatcher
        else numba.jit(**options)(function)
    )
    dispatcher.get_call_template = _call_exactly(dispatcher.get_call_template)
    return cast(F, dispatcher)


def _call_exactly(find: Callable[[Any, Any], Any]) -> Callable[[Any, Any], Any]:
    """Kernels call what is compiled for their types: numba would take a record that begins alike.

    A number that the caller writes out has the type of any number: numba would compile the callee once more.
    """

    def get_call_template(args: Any, kws: Any) -> Any:
        plain = [numba.types.unliteral(arg) for arg in args]
        template, pysig, args, kws = find(
            plain, {name: numba.types.unliteral(arg) for name, arg in kws.items()}
        )
        template.cases = [case for case in template.cases if case.args == tuple(args)] or template.cases
        return template, pysig, args, kws

    return get_call_template


def _view_as_record(context: Any, vector: Any, dtype: Any) -> Any:
    """The record of that type which shares the vector's memory.

    As `vector.view(dtype)[0]`, without its checks of what layouts make sure of, which numba compiles at
    every call.
    """

    def address(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        array = context.make_array(signature.args[0])(context, builder, arguments[0])
        return builder.bitcast(array.data, context.get_value_type(signature.return_type))

    return dtype.dtype(vector, dtype), address


def _view_plainly(vector: Any, dtype: Any) -> Any:
    """The same without compilation; nothing is shared with an empty record, as of no states."""
    return vector.view(dtype)[0] if dtype.itemsize else np.zeros(1, dtype)[0]


# record_of(vector, dtype), in kernels only.
record_of: Any = numba.extending.intrinsic(_view_as_record) if COMPILED else _view_plainly


def _reshape(context: Any, vector: Any, shape: Any) -> Any:
    """The array of that shape, row by row, that shares the vector's memory.

    As `vector.reshape(shape)`, without the errors that numba compiles with it.
    """
    sizes = numba.types.UniTuple(numba.types.intp, len(shape))

    def address(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        source = context.make_array(signature.args[0])(context, builder, arguments[0])
        result = context.make_array(signature.return_type)(context, builder)
        counts = numba.core.cgutils.unpack_tuple(builder, arguments[1])
        strides = [source.itemsize]
        for count in counts[:0:-1]:
            strides.insert(0, builder.mul(count, strides[0]))
        numba.np.arrayobj.populate_array(
            result, data=source.data, shape=counts, strides=strides, itemsize=source.itemsize, meminfo=None
        )
        return result._getvalue()

    return vector.copy(ndim=len(shape))(vector, sizes), address


# shaped(vector, shape), in kernels only.
shaped: Any = numba.extending.intrinsic(_reshape) if COMPILED else lambda vector, shape: vector.reshape(shape)


@kernel
def borrow(array: Any) -> Any:
    """The same array without a count of its references, which costs time where records of arrays are passed.

    It is valid as long as the caller's array is.
    """
    return shaped(array, array.shape)


def _allocate(context: Any, dtype: Any) -> Any:
    """A vector of as many numbers as the record type has, on the stack of the calling kernel."""
    size = dtype.dtype.size // 8
    vector = numba.types.Array(numba.types.float64, 1, "C")

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        cgutils = numba.core.cgutils
        room = cgutils.alloca_once(builder, context.get_value_type(numba.types.float64), size)
        result = context.make_array(signature.return_type)(context, builder)
        length, stride = (context.get_constant(numba.types.intp, value) for value in (size, 8))
        numba.np.arrayobj.populate_array(
            result, data=room, shape=[length], strides=[stride], itemsize=stride, meminfo=None
        )
        return result._getvalue()

    return vector(dtype), generate


# scratch(dtype), in kernels only: valid until the kernel that calls it returns. Its content is not set.
scratch: Any = (
    numba.extending.intrinsic(_allocate) if COMPILED else lambda dtype: np.zeros(dtype.itemsize // 8)
)
