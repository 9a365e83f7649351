"""Shared libraries of a component for every platform, made on any one of them.

LLVM, as numba has it, makes machine code of the translated kernels; the C compiler and linkers for all
platforms come with the package `ziglang`.
"""

import platform
import re
import subprocess
import sys
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from importlib import metadata
from pathlib import Path
from typing import Any

import fmpy

from models.compile.temporary import TemporaryFolder
from models.core.errors import MistakeError
from models.native.differentiate import llvm
from models.native.translate import MATHEMATICS

RUNTIME = Path(__file__).parent / "runtime"
FMI_HEADERS = Path(fmpy.__file__).parent / "c-code"


@dataclass(frozen=True)
class Platform:
    """A processor and operating system, as LLVM, zig, FMI 2 and FMI 3 call it."""

    triple: str
    zig: str
    fmi2: str
    fmi3: str
    suffix: str


_LINUX, _WINDOWS, _MAC = (".so", "linux-gnu.2.17"), (".dll", "windows-gnu"), (".dylib", "macos.11.0")


def _platforms() -> Iterator[Platform]:
    """FMI 2 has no names for those with ARM; these are in use (fmpy's among others)."""
    for (suffix, zig), triple, fmi2, fmi3 in (
        (_LINUX, "x86_64-unknown-linux-gnu", "linux64", "x86_64-linux"),
        (_LINUX, "aarch64-unknown-linux-gnu", "aarch64-linux", "aarch64-linux"),
        (_WINDOWS, "x86_64-pc-windows-gnu", "win64", "x86_64-windows"),
        (_MAC, "x86_64-apple-macosx11.0.0", "darwin64", "x86_64-darwin"),
        (_MAC, "arm64-apple-macosx11.0.0", "aarch64-darwin", "aarch64-darwin"),
    ):
        processor = fmi3.partition("-")[0]
        yield Platform(triple, f"{processor}-{zig}", fmi2, fmi3, suffix)


PLATFORMS: Mapping[str, Platform] = {place.fmi3: place for place in _platforms()}
# What a host of WebAssembly components runs, and a browser; FMI 2 has no such platform.
WEBASSEMBLY = Platform("wasm32-unknown-unknown", "wasm32-wasi", "", "wasm32-wasip2", ".wasm")
# The last one on demand.
CHOICES: Mapping[str, Platform] = {**PLATFORMS, WEBASSEMBLY.fmi3: WEBASSEMBLY}

_SYSTEMS = {"win32": "windows"}
_PROCESSORS = {"AMD64": "x86_64", "arm64": "aarch64"}


def this_platform() -> str:
    """The name of the platform that this process runs on; NativeBuildError if it is none of them."""
    machine = platform.machine()
    name = f"{_PROCESSORS.get(machine, machine)}-{_SYSTEMS.get(sys.platform, sys.platform)}"
    if name not in PLATFORMS:
        raise NativeBuildError(f"no native FMUs for {name}: there are {', '.join(PLATFORMS)}")
    return name


# Small, as a file holds five of them; what runs for long are the kernels. No tables for unwinding: nothing is
# thrown through C.
_C = ["-std=c11", "-Os", "-ffp-contract=off", "-fvisibility=hidden", "-fno-sanitize=all"]
_C += ["-fno-unwind-tables", "-fno-asynchronous-unwind-tables", "-fomit-frame-pointer"]
STRICT = ["-Wall", "-Wextra", "-Werror"]
# By the suffix of libraries: without what identifies builds or names what is not exported.
_LINKED = {
    ".so": ["-shared", "-Wl,--hash-style=sysv", "-Wl,--build-id=none", "-Wl,--gc-sections"],
    ".dylib": ["-shared", "-Wl,-x"],
    ".wasm": ["-mexec-model=reactor", "-Wl,--gc-sections", "-Wl,-z,stack-size=1048576"],
}

# Of Windows' C library, by the part that has them.
_UCRT = {
    "math": sorted(MATHEMATICS - {"memcpy", "memmove", "memset"}),
    "private": ["memcmp", "memcpy", "memmove", "strchr"],
    "string": ["memset", "strcmp", "strcpy", "strlen", "strncmp"],
    "heap": ["calloc", "free", "malloc"],
    "stdio": ["__stdio_common_vsprintf"],
}


class NativeBuildError(MistakeError):
    """The tools that make machine code are missing or failed; the message says which and why."""


def shared_library(
    place: Platform, kernels: Sequence[str], tables: Mapping[str, str], name: str, fmi: int = 2
) -> bytes:
    """The library `name` for a platform, or its module: the runtime for a version of FMI, tables, and kernels
    (modules in LLVM's language)."""
    with TemporaryFolder() as here:
        (here / "kernels.o").write_bytes(object_code(place, kernels))
        for file, text in tables.items():
            (here / file).write_text(text, encoding="utf-8")
        for path in RUNTIME.iterdir():
            (here / path.name).write_bytes(path.read_bytes())
        sources = [*(source.name for source in runtime_sources(fmi)), "tables.c"]
        target = f"{name}{place.suffix}"
        compiler = ["cc", "-target", place.zig, *_C, *STRICT, "-I.", f"-I{FMI_HEADERS}"]
        if place.suffix == ".dll":
            for source in sources:
                run_zig([*compiler, "-D__USE_MINGW_ANSI_STDIO=0", "-c", source, "-o", f"{source}.o"], here)
            _link_for_windows(here, target)
        else:
            linked = ["-s", *_LINKED[place.suffix], "-lm"]
            run_zig([*compiler, *sources, "kernels.o", *linked, "-o", target], here)
        return (here / target).read_bytes()


def _link_for_windows(folder: Path, target: str) -> None:
    """Of all object files there. Without the start-up code and the additions to the C library that zig would
    compile, which are larger than most units; what is needed of them is in runtime/windows.c."""
    objects = sorted(path.name for path in folder.glob("*.o"))
    libraries = []
    for part, names in _UCRT.items():
        lines = [f"LIBRARY api-ms-win-crt-{part}-l1-1-0.dll", "EXPORTS", *names]
        (folder / f"{part}.def").write_text("\n".join(lines), encoding="utf-8")
        libraries.append(f"{part}.lib")
        run_zig(["dlltool", "-m", "i386:x86-64", "-d", f"{part}.def", "-l", libraries[-1]], folder)
    options = ["/dll", "/noentry", "/lldmingw", "/machine:x64", "/opt:ref", "/opt:icf", "/timestamp:0"]
    run_zig(["lld-link", *options, f"/out:{target}", *objects, *libraries], folder)


def runtime_sources(fmi: int) -> list[Path]:
    """The C files of the runtime for a version of FMI."""
    paths = sorted(RUNTIME.glob("*.c"))
    return [path for path in paths if path.name.startswith(f"fmi{fmi}") or not path.name.startswith("fmi")]


def library_licenses() -> dict[str, str]:
    """The licences by name of the C library that is linked into WebAssembly, from zig, which ships it."""
    library = Path(str(metadata.distribution("ziglang").locate_file("ziglang/lib/libc/wasi")))
    parts = {
        "wasi-libc": "LICENSE",
        "wasi-libc-MIT": "LICENSE-MIT",
        "cloudlibc": "libc-bottom-half/cloudlibc/LICENSE",
        "musl": "libc-top-half/musl/COPYRIGHT",
    }
    return {name: (library / place).read_text("utf-8") for name, place in parts.items()}


def run_zig(arguments: Sequence[str], folder: Path) -> None:
    """Call zig in a folder; NativeBuildError with what it says."""
    made = subprocess.run(
        [sys.executable, "-m", "ziglang", *arguments], cwd=folder, capture_output=True, text=True
    )
    if made.returncode:
        raise NativeBuildError(f"zig {' '.join(arguments)}: {made.stderr.strip()}")


# What numba made has places for pointers of 64 bits: in records, which it reads and writes by their bytes.
_RECORD = re.compile(r"(?<= = alloca ){.*}(?=, align)")
# Whatever else lies in the memory otherwise where pointers are shorter.
_POINTERS = re.compile(
    r"(?:load|store|alloca|getelementptr)(?: \w+)* (?:[{\[<][^%@]*\bptr\b[^%@]*[}\]>]|ptr, i64 )"
    r"|getelementptr(?: \w+)* ptr, "
)


def _widen(kernels: str) -> str:
    """The same kernels where pointers have 32 bits. NativeBuildError for what would not be the same."""
    wide = _RECORD.sub(lambda record: re.sub(r"\bptr\b", "i64", record[0]), kernels)
    if found := _POINTERS.search(wide):
        raise NativeBuildError(
            f"no code for {WEBASSEMBLY.fmi3}: a kernel keeps pointers in an array: {found[0]}"
        )
    return wide


def object_code(place: Platform, kernels: Sequence[str]) -> bytes:
    """Machine code of the kernels, and of their tangents if they follow, optimised for the platform, with the
    same bits as numba's: no operation is reordered or fused."""
    if place == WEBASSEMBLY:
        kernels = list(map(_widen, kernels))
    binding = llvm()
    target = binding.Target.from_triple(place.triple)
    machine = target.create_target_machine(opt=3, reloc="pic", codemodel="default")
    layout = str(machine.target_data)
    plain, *tangents = (
        _optimise(text, place.triple, layout, machine, not i) for i, text in enumerate(kernels)
    )
    for other in tangents:
        plain.link_in(other)
    # Tables stand in both.
    passes = binding.create_new_module_pass_manager()
    passes.add_constant_merge_pass()
    passes.run(plain, binding.create_pass_builder(machine, binding.create_pipeline_tuning_options()))
    _hide(plain)
    return machine.emit_object(plain)


def _optimise(text: str, triple: str, layout: str, machine: Any, vectors: bool) -> Any:
    """A module with all that makes it faster, but for what makes it larger and no faster: loops written out,
    and vectors of values that happen to stand together. `vectors`: loops compute several elements at once."""
    binding = llvm()
    module = binding.parse_assembly(text)
    module.triple, module.data_layout = triple, layout
    tuning = binding.create_pipeline_tuning_options(speed_level=2)
    tuning.loop_vectorization = vectors
    tuning.slp_vectorization = tuning.loop_unrolling = False
    builder = binding.create_pass_builder(machine, tuning)
    builder.getModulePassManager().run(module, builder)
    return module


def _hide(module: Any) -> None:
    """What the runtime calls is not exported; of the rest not even names are left."""
    for place in (*module.functions, *module.global_variables):
        if place.is_declaration:
            continue
        if place.linkage == llvm().Linkage.external:
            place.visibility = "hidden"
        else:
            place.linkage = "private"
