"""Tests marked `plain` run kernels as the Python functions that they are; those that are long, compiled.

Laws of a few evaluations take milliseconds so, and seconds to compile. That compiled code computes the same
is the law of `models/test_plain_python.py`.
"""

import ctypes
import sys
from typing import Any

import numpy as np
import pytest
from numba.core.registry import CPUDispatcher

from models.compile import array_pointers, kernel
from models.compile.kernel import COMPILED, KernelDispatcher

# numba's intrinsics, which Python cannot call: bound anew in the modules that use them.
INTRINSICS = {
    "record_of": lambda vector, dtype: vector.view(dtype)[0] if vector.size else np.zeros(1, dtype)[0],
    "shaped": lambda vector, shape: vector.reshape(shape),
    "scratch": lambda dtype: np.zeros(dtype.itemsize // 8),
    "_pointer": lambda address: ctypes.c_void_p(int(address)),
}
COMPILED_INTRINSICS = {
    name: getattr(array_pointers if name == "_pointer" else kernel, name) for name in INTRINSICS
}


def _call(self: Any, *arguments: Any) -> Any:
    with np.errstate(all="ignore"):  # as compiled code
        return self.py_func(*arguments)


@pytest.fixture(autouse=True)
def plain_kernels(request):
    """What the markers say."""
    marked = {mark.name for mark in request.node.iter_markers()}
    if "plain" in marked and "long" not in marked and COMPILED and KernelDispatcher:
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr(CPUDispatcher, "__call__", _call)  # also of what is compiled but no kernel
            bind(INTRINSICS)
            yield
        # Also in modules that the test was the first to import.
        bind(COMPILED_INTRINSICS)
    else:
        yield


def bind(intrinsics: dict[str, Any]) -> None:
    """Give all modules of `models` that use intrinsics these ones."""
    for name, module in list(sys.modules.items()):
        for intrinsic, function in intrinsics.items() if name.startswith("models.") else ():
            if hasattr(module, intrinsic):
                setattr(module, intrinsic, function)
