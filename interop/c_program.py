"""The program in C (host.c), compiled for a platform, and how the tools that use it run it."""

import os
import struct
import subprocess
import sys
import sysconfig
import zipfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from .case import Case, RefusedError, report_loaded

SOURCE = Path(__file__).with_name("host.c")
WARNINGS = ["-Wall", "-Wextra", "-Werror"]


def compile_host(folder: Path, target: str = "", suffix: str = "") -> Path:
    """Compile the program for zig's `target`, by default this machine."""
    import fmpy

    program = folder / f"host{suffix}"
    platform = ["-target", target] if target else ["-mcpu=baseline"]
    command = [sys.executable, "-m", "ziglang", "cc", *platform, "-O1", "-std=gnu11", *WARNINGS]
    command += [f"-I{Path(fmpy.__file__).parent / 'c-code'}", str(SOURCE), "-o", str(program)]
    compiled = subprocess.run(command, capture_output=True, text=True, check=False)
    if compiled.returncode:
        raise RefusedError(f"host.c does not compile: {compiled.stderr.strip()[-1000:]}")
    return program


def find_libpython() -> Path | None:
    """The shared library of this Python, or None if it was built without."""
    name = sysconfig.get_config_var("INSTSONAME") or sysconfig.get_config_var("LDLIBRARY") or ""
    path = Path(sysconfig.get_config_var("LIBDIR") or "") / name
    return path if path.is_file() and ".so" in name else None


@dataclass(frozen=True)
class Host:
    """The program and how to start it.

    places: the folder of an FMU's binaries, by FMI version. runner: the command that runs the program.
    preload: the library that it loads first, or "-". drive: prefix of paths inside the program.
    """

    program: Path
    places: Mapping[int, str] = field(default_factory=lambda: {2: "linux64", 3: "x86_64-linux"})
    suffix: str = ".so"
    runner: Sequence[str] = ()
    preload: str = "-"
    drive: str = ""

    def values(self, case: Case, at_end: str = "free", **environment: str) -> list[list[float]]:
        """Outputs after each step. The program frees its instance at the end, unless `at_end` is "keep"."""
        process = self._start(case, at_end, environment)
        said, errors = process.communicate("")
        if said.startswith("LOADED"):
            report_loaded()
        if process.returncode:
            words = "; ".join(errors.strip().splitlines()[-2:]) or "no message"
            raise RefusedError(f"{words} (exit status {process.returncode})")
        return [[_value(bits) for bits in line.split()] for line in said.splitlines()[1:]]

    def _start(self, case: Case, at_end: str, environment: Mapping[str, str]) -> subprocess.Popen[str]:
        folder = self.program.parent / "unpacked"
        with zipfile.ZipFile(case.fmu) as archive:
            archive.extractall(folder)
        library = folder / "binaries" / self.places[case.fmi] / f"{case.identifier}{self.suffix}"
        if not library.is_file():
            raise RefusedError(f"the FMU has no binary in {self.places[case.fmi]}")
        (folder / "numbers").write_text(format_case(case))
        seen = [f"{self.drive}{path}" for path in (library, folder / "resources", folder / "numbers")]
        seen[1] = f"file:///{seen[1].lstrip('/')}" if case.fmi == 2 else f"{seen[1]}/"
        command = [*self.runner, self.program, self.preload, *seen[:2], case.token, seen[2], at_end]
        # Python inside the program finds the packages of the interpreter that comes first on the path.
        path = os.pathsep.join([str(Path(sys.executable).parent), os.environ.get("PATH", "")])
        variables = {key: value for key, value in os.environ.items() if not key.startswith("PYTHON")}
        return subprocess.Popen(
            [str(part) for part in command],
            cwd=self.program.parent,
            env=variables | {"PATH": path} | dict(environment),
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
            errors="replace",
        )


def format_case(case: Case) -> str:
    """The case in the format that host.c reads."""
    counts = [len(case.inputs), len(case.outputs), case.steps]
    lines = [f"{case.fmi} {_bits(case.step)}", " ".join(map(str, counts))]
    lines += [" ".join(map(str, case.find_references(names))) for names in (case.inputs, case.outputs)]
    lines += [" ".join(map(_bits, row)) for row in case.table]
    return "\n".join(lines) + "\n"


def _bits(value: float) -> str:
    return struct.pack(">d", value).hex()


def _value(bits: str) -> float:
    (value,) = struct.unpack(">d", bytes.fromhex(bits))
    return float(value)
