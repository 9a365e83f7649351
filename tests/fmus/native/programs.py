"""Programs in C that host native FMUs, compiled here; and libraries with checks of every access to memory."""

import functools
import math
import re
import shutil
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path

import fmpy
import pytest
from fmpy.model_description import ModelDescription, ScalarVariable

from fmus.build import resolve_component
from fmus.native.machine_code import (
    FMI_HEADERS,
    PLATFORMS,
    RUNTIME,
    object_code,
    runtime_sources,
    this_platform,
)
from fmus.native.tables import tables
from models.native.differentiate import differentiate
from models.native.entries import smooth
from models.native.translate import translate

HERE = Path(__file__).parent
TOKEN = "{sanitized}"
WARNINGS = ["-Wall", "-Wextra", "-Werror", f"-I{FMI_HEADERS}"]
# Ends at an access outside of what is allocated, and at what C leaves undefined; tells leaks at the end.
SANITIZED = ["-g", "-O1", "-fsanitize=address,undefined,float-cast-overflow", "-fno-sanitize-recover=all"]


@functools.cache
def sanitizing_compiler() -> str | None:
    """gcc, if it has its sanitizers with it. zig's clang comes without the one for addresses."""
    gcc = shutil.which("gcc")
    if gcc is None or not sys.platform.startswith("linux"):
        return None
    command = [gcc, *SANITIZED, "-x", "c", "-", "-o", "/dev/null"]
    return (
        gcc
        if subprocess.run(command, input=b"int main(void) {}", capture_output=True).returncode == 0
        else None
    )


def program(name: str, folder: Path, sanitized: bool, fmi: int = 2) -> Path:
    """The program of `name`.c for a version of FMI, compiled by zig, or with sanitizers by gcc."""
    target = folder / f"{name}{'-sanitized' * sanitized}"
    # For any processor of this kind: valgrind does not know the latest instructions.
    compiler = [sys.executable, "-m", "ziglang", "cc", "-O1", "-mcpu=baseline"]
    if sanitized:
        compiler = [sanitizing_compiler() or "gcc", *SANITIZED]
    source = str(HERE / f"{name}.c")
    options = ["-std=gnu11", f"-DFMI={fmi}", *WARNINGS]
    subprocess.run([*compiler, *options, source, "-o", str(target), "-ldl", "-lm"], check=True)
    return target


@functools.cache
def kernels(name: str) -> bytes:
    """Machine code of the component's kernels."""
    sizes, component = resolve_component(name, None)
    plain = translate(name, sizes)
    return object_code(PLATFORMS[this_platform()], [plain, differentiate(plain, smooth(component))])


def sanitized_library(name: str, folder: Path, fmi: int) -> Path:
    """The FMU's library with sanitizers in the runtime, its kernels as shipped; its token is TOKEN."""
    _, component = resolve_component(name, None)
    (folder / "kernels.o").write_bytes(kernels(name))
    for file, text in tables(component, name, "0" * 16, TOKEN, fmi).items():
        (folder / file).write_text(text, encoding="utf-8")
    target = folder / f"{name}.so"
    inputs = [*runtime_sources(fmi), folder / "tables.c", folder / "kernels.o", "-lm", "-o", target]
    compiler = [
        sanitizing_compiler() or "gcc",
        *SANITIZED,
        "-std=c11",
        "-ffp-contract=off",
        "-fPIC",
        "-shared",
    ]
    subprocess.run([*compiler, *WARNINGS, f"-I{RUNTIME}", f"-I{folder}", *map(str, inputs)], check=True)
    return target


def stepped_program(name: str, folder: Path) -> Path:
    """That of stepped.c for a component, with the mathematical library of WebAssembly's, musl's."""
    _, component = resolve_component(name, None)
    (folder / "kernels.o").write_bytes(kernels(name))
    for file, text in tables(component, name, "0" * 16, TOKEN, 3).items():
        (folder / file).write_text(text, encoding="utf-8")
    target = folder / "stepped"
    options = ["-target", "x86_64-linux-musl", "-mcpu=baseline", "-std=c11", "-O2", "-ffp-contract=off"]
    inputs = [HERE / "stepped.c", *runtime_sources(3), folder / "tables.c", folder / "kernels.o", "-lm"]
    command = [sys.executable, "-m", "ziglang", "cc", *options, *WARNINGS, f"-I{RUNTIME}", f"-I{folder}"]
    subprocess.run([*command, *map(str, inputs), "-o", str(target)], check=True)
    return target


def needs_sanitizers() -> None:
    if sanitizing_compiler() is None:
        pytest.skip("needs gcc with its sanitizers, on Linux")


def run(command: Sequence[object], timeout: float) -> str:
    """What the program prints, which must end well."""
    finished = subprocess.run(
        list(map(str, command)), capture_output=True, text=True, timeout=timeout, check=False
    )
    assert finished.returncode == 0, (finished.stdout + finished.stderr)[-4000:]
    return finished.stdout


def variables_for_c(description: ModelDescription) -> str:
    """The variables as fuzz.h reads them."""
    known = [v for v in description.modelVariables if v.causality != "independent"]
    states = {unknown.variable.derivative.name for unknown in description.derivatives}
    return "".join(f"{_variable(v, description.fmiVersion[0], v.name in states)}\n" for v in known)


_KINDS = {
    "2": {"Real": "r", "Integer": "i", "Enumeration": "i", "Boolean": "b"},
    "3": {"Float64": "r", "Int32": "i", "Enumeration": "e", "Boolean": "b"},
}


def _variable(variable: ScalarVariable, fmi: str, state: bool) -> str:
    kind = _KINDS[fmi][variable.type]
    derivative = variable.causality == "input" and re.search(r"_der\d", variable.name)
    causality = "d" if derivative else "s" if state else variable.causality[0]
    words = {"true": 1.0, "false": 0.0}
    start = (variable.start or "0.0").split()[0]
    size = math.prod(variable.shape or ())
    number = words[start] if start in words else float(start)
    return f"{variable.valueReference} {kind} {causality} {variable.variability[0]} {size} {number!r}"


def library_in(fmu: Path, folder: Path) -> tuple[Path, ModelDescription]:
    """The library of a packaged native FMU for this machine, unpacked, and its description."""
    fmpy.extract(str(fmu), str(folder))
    description = fmpy.read_model_description(str(folder), validate=False)
    place = PLATFORMS[this_platform()]
    identifier = description.coSimulation.modelIdentifier
    of_platform = place.fmi2 if description.fmiVersion.startswith("2") else place.fmi3
    return folder / "binaries" / of_platform / f"{identifier}{place.suffix}", description
