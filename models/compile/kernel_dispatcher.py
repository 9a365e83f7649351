"""numba's dispatcher of kernels: only large ones that kernels call have machine code of their own.

Most kernels are called by kernels only, which link them. The machine code and the entry for Python that numba
would make for each of them take a third of the time of compilation.
"""

import contextlib
import gc
from collections.abc import Callable, Iterator
from typing import Any

from numba.core import dispatcher, registry, sigutils
from numba.core.compiler_lock import global_compiler_lock

from .kernel_cache import KernelCache, Link, LinkedKernelCache, finalize, keep_apart

# numba's, whose types say little.
normalized: Any = sigutils.normalize_signature

# Objects after which Python looks for garbage in circles while numba compiles: it makes millions, nearly all
# of them kept. With Python's own 700 that takes a twelfth of the time, with these half of it.
COLLECTED = 50_000


@contextlib.contextmanager
def _rare_collections() -> Iterator[None]:
    """Look for garbage after COLLECTED objects at the earliest; not at all where that is chosen (0)."""
    youngest, *older = before = gc.get_threshold()
    gc.set_threshold(max(youngest, COLLECTED) if youngest else 0, *older)
    try:
        yield
    finally:
        gc.set_threshold(*before)


class _Compiler(dispatcher._FunctionCompiler):
    """As numba's; large kernels that are called have machine code, and aren't linked."""

    def _customize_flags(self, flags: Any) -> Any:
        flags.no_compile = True  # here, after `keep_apart`
        return flags

    def _compile_core(self, args: Any, return_type: Any) -> Any:
        compiled = super()._compile_core(args, return_type)
        keep_apart(compiled.library)
        entry = self._enter(compiled)
        context = self.targetdescr.target_context
        context.insert_user_function(entry, compiled.fndesc, [compiled.library])
        return compiled._replace(entry_point=entry)

    def _enter(self, compiled: Any) -> Any:
        """An entry point for Python."""
        context = self.targetdescr.target_context
        return context.get_executable(compiled.library, compiled.fndesc, compiled.environment)


class _LinkCompiler(_Compiler):
    """Compiles to code for callers."""

    def _customize_flags(self, flags: Any) -> Any:
        flags.no_compile = flags.no_cpython_wrapper = True
        return flags

    def _enter(self, compiled: Any) -> Any:
        finalize(compiled.library, compiled.fndesc.llvm_func_name)
        return Link()


class KernelDispatcher(registry.CPUDispatcher):
    """Compiles a kernel once for its callers among kernels, and once more if Python calls it too."""

    def __init__(self, py_func: Callable[..., Any], locals: Any = None, targetoptions: Any = None) -> None:
        super().__init__(py_func, locals or {}, targetoptions)
        given = py_func, self.targetdescr, targetoptions, self.locals, self._compiler.pipeline_class
        self._compiler, self._link_compiler = _Compiler(*given), _LinkCompiler(*given)
        options = repr(sorted(targetoptions.items()))
        self._cache = KernelCache(py_func, options)
        self._link_cache = LinkedKernelCache(py_func, options)

    def get_call_template(self, args: Any, kws: Any) -> Any:
        """numba asks for it where it compiles a caller, which links the code."""
        usual = self._compiler, self._cache
        self._compiler, self._cache = self._link_compiler, self._link_cache
        try:
            return super().get_call_template(args, kws)
        finally:
            self._compiler, self._cache = usual

    def compile(self, sig: Any) -> Any:
        """As numba does; code for callers has no entry for Python."""
        with global_compiler_lock, _rare_collections():
            args = tuple(normalized(sig)[0])
            for_python = self._compiler is not self._link_compiler
            if for_python and args in self.overloads and _is_linked(self.overloads[args]):
                del self.overloads[args]
            return super().compile(sig)

    def add_overload(self, compiled: Any) -> None:
        """As numba does; code for callers is not for Python."""
        if _is_linked(compiled):
            self.overloads[tuple(compiled.signature.args)] = compiled
        else:
            super().add_overload(compiled)


def _is_linked(compiled: Any) -> bool:
    return isinstance(compiled.entry_point, Link)
