"""Tangents of components' kernels in this process, compiled once and kept.

A tangent is called by its address, as tangent(t, dt, x, dx, u, du, p, dp, y, dy) with addresses of numbers.
"""

import hashlib
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from functools import cache
from importlib import metadata
from pathlib import Path
from typing import Any

from ..compile.cache_folder import open_folder
from ..compile.kernel import COMPILED
from ..core.component import Component
from ..core.errors import MistakeError
from .differentiate import differentiate, llvm
from .translate import TranslationError, translate

numba: Any
cgutils: Any
if COMPILED:
    import numba
    from numba.core import cgutils

ENTRIES = ("output", "derivative")
# Folder in the user's cache.
KEPT = "tangents"


class Tangents:
    """Addresses of a component's tangents, by entry; they are valid as long as this is kept."""

    def __init__(self, text: str) -> None:
        binding = llvm()
        module = binding.parse_assembly(text)
        machine = binding.Target.from_default_triple().create_target_machine(opt=2)
        builder = binding.create_pass_builder(machine, binding.create_pipeline_tuning_options(speed_level=2))
        builder.getModulePassManager().run(module, builder)
        self._engine = binding.create_mcjit_compiler(module, machine)
        self._engine.finalize_object()
        self.address = {name: int(self._engine.get_function_address(f"tangent_{name}")) for name in ENTRIES}


def find_tangents(components: Sequence[Component]) -> list[Tangents]:
    """Those of these components; MistakeError for one whose kernels cannot be translated."""
    if not COMPILED:
        raise TranslationError("derivatives of kernels need numba, which is not installed or switched off")
    keys = [(one.name, tuple(sorted(one.structure.items()))) for one in components]
    with ThreadPoolExecutor() as pool:
        found = dict(
            zip(dict.fromkeys(keys), pool.map(lambda key: _text(*key), dict.fromkeys(keys)), strict=True)
        )
    return [_load(found[key]) for key in keys]


@cache
def _load(text: str) -> Tangents:
    return Tangents(text)


@cache
def _text(name: str, structure: tuple[tuple[str, int], ...]) -> str:
    """In LLVM's language; kept in the user's cache under the digest of all models."""
    digest = hashlib.sha256(f"{name} {structure} {_sources()}".encode()).hexdigest()
    try:
        with open_folder(KEPT) as folder:
            try:
                return folder.read(digest).decode()
            except FileNotFoundError:
                text = differentiate(translate(name, dict(structure), ENTRIES), ENTRIES)
                folder.write(digest, text.encode())
                return text
    except MistakeError:
        raise
    except OSError:
        return differentiate(translate(name, dict(structure), ENTRIES), ENTRIES)


@cache
def _sources() -> str:
    digest = hashlib.sha256()
    for path in sorted(Path(__file__).parents[1].rglob("*.py")):
        digest.update(path.read_bytes())
    return digest.hexdigest() + metadata.version("numba") + metadata.version("llvmlite")


def _call(context: Any, address: Any, t: Any, places: Any) -> Any:
    """The tangent at that address, of time t, with the addresses x, dx, u, du, p, dp, y, dy in `places`."""
    types = numba.types

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        function, time, whole = arguments
        pointer, number = cgutils.voidptr_t, cgutils.ir.DoubleType()
        kinds = [pointer, pointer, number, number, *[pointer] * 8]
        kind = cgutils.ir.FunctionType(cgutils.ir.IntType(32), kinds)
        result = cgutils.alloca_once(builder, cgutils.ir.IntType(64))
        error = cgutils.alloca_once(builder, pointer)
        passed = [builder.bitcast(one, pointer) for one in (result, error)]
        passed += [time, number(0.0)]
        passed += [builder.inttoptr(one, pointer) for one in cgutils.unpack_tuple(builder, whole, 8)]
        builder.call(builder.inttoptr(function, kind.as_pointer()), passed)
        return context.get_dummy_value()

    return types.none(types.int64, types.float64, types.UniTuple(types.int64, 8)), generate


# call_tangent(address, t, places), in kernels only.
call_tangent: Any = numba.extending.intrinsic(_call) if COMPILED else None
