"""A component's entries in LLVM's intermediate language, for any processor: `translate("camshaft", {})`.

Compiled in a process of its own for a processor without peculiarities, so that every machine makes the same.
What the code calls must be elementary mathematics or LLVM's own: kernels that allocate, raise or call Python
are refused by name.
"""

import hashlib
import os
import re
import subprocess
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from ..compile.cache_folder import private_folder
from ..core.errors import MistakeError

# Of the C library; LLVM's intrinsics become calls of the same.
_FUNCTIONS = """
acos acosh asin asinh atan atan2 atanh cbrt ceil copysign cos cosh erf erfc exp exp2 expm1 fabs floor
fma fmax fmin fmod hypot ldexp lgamma log log10 log1p log2 memcpy memmove memset pow round sin sinh sqrt
tan tanh tgamma trunc
"""
MATHEMATICS = frozenset(_FUNCTIONS.split())
# What it writes out several times is larger and no faster: loops, and functions in the place of their calls.
_SMALL = ("--unroll-full-max-count=1", "--inline-threshold=75")
# numba counts references to arrays that own their memory; those that C hands in have none.
_COUNTING = ("NRT_incref", "NRT_decref")
_PLAIN_PROCESSOR = {
    "NUMBA_CPU_NAME": "generic",
    "NUMBA_CPU_FEATURES": "",
    "NUMBA_OPT": "1",  # the rest is left to the compiler of each platform
    "NUMBA_LOOP_VECTORIZE": "0",
    "NUMBA_SLP_VECTORIZE": "0",
}


class TranslationError(MistakeError):
    """A kernel does what machine code without Python cannot; the message says what."""


def translate(name: str, structure: Mapping[str, int], wanted: Sequence[str] = ()) -> str:
    """The `wanted` entries (none: all) of the component `name`, with these sizes, as kernel_<entry>."""
    sizes = [f"{key}={value}" for key, value in sorted(structure.items())]
    root = Path(__file__).parents[2]
    file = name.rpartition(":")[0]
    beside = str(Path(file).parent) if file.endswith(".py") else ""
    path = os.pathsep.join(filter(None, (str(root), beside, os.environ.get("PYTHONPATH"))))
    # Kernels that were compiled otherwise, for this process, are not taken from the cache.
    options = hashlib.sha256(repr((_PLAIN_PROCESSOR, _SMALL, "linked")).encode()).hexdigest()
    try:
        kept = private_folder(f"translated-{options[:16]}")
    except OSError:
        kept = Path(os.devnull)  # which holds no folders: nothing is kept
    made = subprocess.run(
        [sys.executable, "-P", "-m", __spec__.name, name, ",".join(wanted), *sizes],
        env=os.environ | _PLAIN_PROCESSOR | {"PYTHONPATH": path, "TRIBOCOSIM_CACHE": str(kept)},
        capture_output=True,
        text=True,
    )
    if made.returncode:
        raise TranslationError(f"native code of {name}: {_summarise(made.stderr)}")
    return made.stdout


def _summarise(text: str) -> str:
    """The error at the end of a traceback and the first line of its explanation; numba's go on below it."""
    lines = [line.strip() for line in re.sub(r"\x1b\[[0-9;]*m", "", text).splitlines()]
    raised = [i for i, line in enumerate(lines) if re.match(r"[\w.]+(Error|Exception)\b", line)]
    lines = [line for line in lines[raised[-1] :] if line][:2] if raised else lines[-1:]
    return " ".join(lines) or "the compiler says nothing"


def _translate(name: str, structure: Mapping[str, int], wanted: Sequence[str]) -> str:
    """As `translate`, in this process."""
    import llvmlite.binding as llvm
    import numba

    njit: Any = numba.njit  # its types lack the options of the wrappers

    for option in _SMALL:  # before what is imported calls its kernels
        llvm.set_option("", option)

    from ..catalogue import find_factory
    from ..compile import kernel_cache
    from .entries import entries

    kernel_cache.LARGE = sys.maxsize  # all that is called is linked
    whole = llvm.parse_assembly("")
    symbols = {}
    for entry in entries(find_factory(name)(**structure)):
        if wanted and entry.name not in wanted:
            continue
        compiled = njit(entry.signature, error_model="numpy", no_cfunc_wrapper=True, no_cpython_wrapper=True)(
            entry.function
        )
        (overload,) = compiled.overloads.values()
        symbols[overload.fndesc.mangled_name] = f"kernel_{entry.name}"
        whole.link_in(llvm.parse_assembly(_without_counting(overload.library.get_llvm_str())))
    for place in (*whole.functions, *whole.global_variables):
        if not place.is_declaration and place.name not in symbols:
            place.linkage = "internal"
    _drop_unused(whole)
    text = str(whole)
    for symbol, plain in symbols.items():
        text = re.sub(rf'@"?{re.escape(symbol)}"?(?=[\s(,])', f"@{plain}", text)
    foreign = sorted(
        f.name
        for f in whole.functions
        if f.is_declaration and not f.name.startswith("llvm.") and f.name not in MATHEMATICS
    )
    if foreign:
        raise TranslationError(f"its kernels call {', '.join(foreign)}; they may call mathematics only")
    lines = text.splitlines()
    kept = (line for line in lines if not line.startswith(("target ", "source_filename", "; ModuleID")))
    return _number_names("\n".join(kept) + "\n")


def _number_names(text: str) -> str:
    """The module's text with names in the order of their appearance in the place of numba's, which count what
    was compiled before in the process."""
    names: dict[str, str] = {}
    return re.sub(r"_ZN\w+", lambda found: names.setdefault(found.group(), f"inner_{len(names)}"), text)


def _without_counting(text: str) -> str:
    """The module's text with empty functions in the place of those that count references."""
    for name in _COUNTING:
        body = rf"^define [^\n]*@{name}\(ptr [^\n]*\{{\n.*?^\}}"
        empty = f"define linkonce_odr void @{name}(ptr %0) {{\n  ret void\n}}"
        text = re.sub(body, empty, text, flags=re.MULTILINE | re.DOTALL)
    return text


def _drop_unused(module: object) -> None:
    import llvmlite.binding as llvm

    machine = llvm.Target.from_default_triple().create_target_machine()
    builder = llvm.create_pass_builder(machine, llvm.create_pipeline_tuning_options(speed_level=0))
    passes = llvm.create_new_module_pass_manager()
    passes.add_global_dead_code_eliminate_pass()
    passes.run(module, builder)


if __name__ == "__main__":
    sizes = (word.split("=") for word in sys.argv[3:])
    chosen = [word for word in sys.argv[2].split(",") if word]
    print(_translate(sys.argv[1], {key: int(value) for key, value in sizes}, chosen), end="")
