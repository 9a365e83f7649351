"""Native FMUs as files: what is in them, and what they need."""

from __future__ import annotations

import re
import subprocess
import sys
import tempfile
import zipfile
from collections.abc import Iterator
from pathlib import Path

import fmpy
from fmpy.model_description import ModelDescription

from fmus.build import NAMES
from fmus.build import build as build_python
from fmus.native.fmu import build
from fmus.native.machine_code import PLATFORMS

from .table import ROOT, Row
from .validators import found

NATIVE = "fmus/native/"
KILOBYTES = 200.0
VERSIONS = (2, 3)
Files = dict[tuple[str, int], Path]


def rows() -> Iterator[Row]:
    with tempfile.TemporaryDirectory() as folder:
        files = every(Path(folder))
        described = {key: fmpy.read_model_description(str(file)) for key, file in files.items()}
        yield _platforms(files)
        yield _sizes(files)
        yield _without_tools(Path(folder))
        yield _variables(described)
        yield _kinds(described)
        yield _validators(files)


def every(folder: Path) -> Files:
    """The native FMUs of all components, versions and platforms."""
    return {(name, fmi): build(name, folder, fmi=fmi) for name in NAMES for fmi in VERSIONS}


def _platforms(files: Files) -> Row:
    whole = 0
    for (name, fmi), file in files.items():
        with zipfile.ZipFile(file) as archive:
            found = {entry for entry in archive.namelist() if entry.startswith("binaries/")}
        folders = {p.fmi2 if fmi == 2 else p.fmi3: p.suffix for p in PLATFORMS.values()}
        whole += found == {f"binaries/{folder}/{name}{suffix}" for folder, suffix in folders.items()}
    return Row(
        "an FMU with binaries for Linux x86-64 and arm64, Windows x86-64, macOS x86-64 and arm64, from one "
        "machine, for every component whose kernels allow it; FMI 2.0 and FMI 3.0",
        f"{len(NAMES)} of {len(NAMES)} components ({', '.join(NAMES)}), both versions: {whole} of "
        f"{len(files)} files have all {len(PLATFORMS)} binaries and no other",
        (NATIVE + "test_fmi3.py::test_it_has_a_library_for_this_machine",),
        command="tribocosim fmu build --native --fmi 3",
        short="" if whole == len(files) else "binaries are missing.",
    )


def _sizes(files: Files) -> Row:
    sizes = {f"{name} (FMI {fmi})": file.stat().st_size / 1000.0 for (name, fmi), file in files.items()}
    largest = sorted(sizes, key=sizes.__getitem__)[::-1]
    over = [name for name in largest if sizes[name] >= KILOBYTES]
    return Row(
        f"size under {KILOBYTES:g} kB without the Windows debug file",
        f"files of five platforms, from {sizes[largest[-1]]:.0f} kB ({largest[-1]}) to "
        + ", ".join(f"{sizes[name]:.0f} kB ({name})" for name in largest[:4])
        + "; there is no debug file in them",
        short=f"above it: {', '.join(f'{name} {sizes[name]:.0f} kB' for name in over)}." if over else "",
    )


def _without_tools(folder: Path) -> Row:
    """A build with nothing on the path, and no cache."""
    code = "from orchestrator.command_line import main; main()"
    command = [
        sys.executable,
        "-c",
        code,
        "fmu",
        "build",
        "camshaft",
        "--native",
        "--platform",
        "x86_64-linux",
    ]
    bare = {"PATH": "", "HOME": str(folder), "XDG_CACHE_HOME": str(folder / "cache"), "PYTHONPATH": str(ROOT)}
    made = subprocess.run(
        [*command, "--out", str(folder / "bare")], env=bare, cwd=folder, capture_output=True, text=True
    )
    done = made.returncode == 0
    return Row(
        "with pip-installable tools only (extra `native`)",
        f"with an empty PATH and an empty cache folder: exit status {made.returncode}; numba, llvmlite and "
        "ziglang come from pip",
        command="tribocosim fmu build camshaft --native",
        short="" if done else made.stderr.strip().splitlines()[-1],
    )


def _variables(described: dict[tuple[str, int], ModelDescription]) -> Row:
    different, more, count = [], set(), 0
    for name in NAMES:
        python = fmpy.read_model_description(str(build_python(name)))
        native = {v.name: v for v in described[name, 2].modelVariables}
        for v in python.modelVariables:
            other = native.pop(v.name, None)
            count += 1
            told = ("valueReference", "type", "causality", "variability", "unit", "min", "max", "start")
            if other is None or any(getattr(v, key) != getattr(other, key) for key in told):
                different.append(f"{name}.{v.name}")
        more |= {re.sub(r"\.[^)]*", ".…", left) for left in native}
    return Row(
        "same modelDescription as the Python FMU (plus what it can do more)",
        f"{count} variables of the FMUs in Python: {len(different)} differ in reference, type, causality, "
        f"variability, unit, limits or start; native ones have besides: {', '.join(sorted(more))}",
        (NATIVE + "test_fmi3.py::test_variables_are_those_of_fmi_2",),
        short=f"different: {', '.join(different[:8])}." if different else "",
    )


def _kinds(described: dict[tuple[str, int], ModelDescription]) -> Row:
    both = [key for key, d in described.items() if d.coSimulation and d.modelExchange]
    events = {name: described[name, 2].numberOfEventIndicators for name in NAMES}
    with_events = ", ".join(f"{name} {n}" for name, n in events.items() if n)
    return Row(
        "Co-Simulation and Model Exchange (with event indicators for impacts and contact)",
        f"{len(both)} of {len(described)} files are of both kinds; event indicators: {with_events}",
        (
            NATIVE + "test_exchange.py::test_the_hosts_integrator_finds_the_same_motion",
            NATIVE + "test_fmi3.py::test_the_hosts_integrator_finds_the_same_motion",
        ),
        short="" if len(both) == len(described) else "not all are of both kinds.",
    )


def _validators(files: Files) -> Row:
    faults, complaints = found(files.values())
    return Row(
        "validators silent for both",
        f"{len(files)} files: {faults} problems from fmpy and `tribocosim fmu validate`, {complaints} from "
        "fmutool",
        (
            NATIVE + "test_exchange.py::test_validators_find_nothing",
            NATIVE + "test_fmi3.py::test_validators_find_nothing",
            NATIVE + "test_fmi3.py::test_fmutool_finds_no_fault",
        ),
        short="not silent." if faults or complaints else "",
    )
