"""The host in C, compiled for some platform, as the tools that are programs run it."""

from __future__ import annotations

import os
import struct
import subprocess
import sys
import sysconfig
import zipfile
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import AbstractContextManager, contextmanager
from dataclasses import dataclass, field, replace
from pathlib import Path

from .case import Case, RefusedError, loaded

SOURCE = Path(__file__).with_name("host.c")
WARNINGS = ["-Wall", "-Wextra", "-Werror"]

# What the file of a tool defines: outputs after every step; and seconds that so many steps take.
Values = Callable[[Case], list[list[float]]]
Timing = Callable[[Case], AbstractContextManager[Callable[[int], float]]]


def compiled(folder: Path, target: str = "", suffix: str = "") -> Path:
    """The program; `target` as zig calls a platform, this machine's without."""
    import fmpy

    program = folder / f"host{suffix}"
    platform = ["-target", target] if target else ["-mcpu=baseline"]
    command = [sys.executable, "-m", "ziglang", "cc", *platform, "-O1", "-std=gnu11", *WARNINGS]
    command += [f"-I{Path(fmpy.__file__).parent / 'c-code'}", str(SOURCE), "-o", str(program)]
    made = subprocess.run(command, capture_output=True, text=True, check=False)
    if made.returncode:
        raise RefusedError(f"host.c does not compile: {made.stderr.strip()[-1000:]}")
    return program


def libpython() -> Path | None:
    """The shared library of this Python, or None if it was built without."""
    name = sysconfig.get_config_var("INSTSONAME") or sysconfig.get_config_var("LDLIBRARY") or ""
    path = Path(sysconfig.get_config_var("LIBDIR") or "") / name
    return path if path.is_file() and ".so" in name else None


@dataclass(frozen=True)
class Host:
    """The program and how it is started: `places`, the folder of an FMU's binaries by version of FMI;
    `runner`, the command that runs it; `preload`, the library that it loads first, or "-"; `drive`, what
    stands before paths as the program sees them."""

    program: Path
    places: Mapping[int, str] = field(default_factory=lambda: {2: "linux64", 3: "x86_64-linux"})
    suffix: str = ".so"
    runner: Sequence[str] = ()
    preload: str = "-"
    drive: str = ""

    def values(self, case: Case, at_end: str = "free", **environment: str) -> list[list[float]]:
        """Outputs after every step; at the end the instance is freed, or with `keep` not."""
        process = self._started(case, at_end, environment)
        said, errors = process.communicate("")
        if said.startswith("LOADED"):
            loaded()
        if process.returncode:
            words = "; ".join(errors.strip().splitlines()[-2:]) or "without a word"
            raise RefusedError(f"{words} (exit status {process.returncode})")
        return [[_value(bits) for bits in line.split()] for line in said.splitlines()[1:]]

    @contextmanager
    def timing(self, case: Case) -> Iterator[Callable[[int], float]]:
        process = self._started(replace(case, table=case.table[:1]), "free", {})
        assert process.stdin is not None
        assert process.stdout is not None
        process.stdout.readline(), process.stdout.readline()

        def seconds(steps: int) -> float:
            print(steps, file=process.stdin, flush=True)
            said = process.stdout.readline()
            if not said:
                raise RefusedError(process.communicate()[1].strip() or "without a word")
            return float(said)

        yield seconds
        process.communicate()

    def _started(self, case: Case, at_end: str, environment: Mapping[str, str]) -> subprocess.Popen[str]:
        folder = self.program.parent / "unpacked"
        with zipfile.ZipFile(case.fmu) as archive:
            archive.extractall(folder)
        library = folder / "binaries" / self.places[case.fmi] / f"{case.identifier}{self.suffix}"
        if not library.is_file():
            raise RefusedError(f"the FMU has no binary in {self.places[case.fmi]}")
        (folder / "numbers").write_text(numbers_of(case))
        seen = [f"{self.drive}{path}" for path in (library, folder / "resources", folder / "numbers")]
        seen[1] = f"file:///{seen[1].lstrip('/')}" if case.fmi == 2 else f"{seen[1]}/"
        command = [*self.runner, self.program, self.preload, *seen[:2], case.token, seen[2], at_end]
        # Python inside the program finds the packages of the interpreter that comes first on the path.
        path = os.pathsep.join([str(Path(sys.executable).parent), os.environ.get("PATH", "")])
        kept = {key: value for key, value in os.environ.items() if not key.startswith("PYTHON")}
        return subprocess.Popen(
            [str(part) for part in command],
            cwd=self.program.parent,
            env=kept | {"PATH": path} | dict(environment),
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
            errors="replace",
        )


def ways(started: Callable[[Case], AbstractContextManager[Host]]) -> tuple[Values, Timing]:
    """A tool's `values` and `timing`, by the program that `started` gives for a case."""

    def values(case: Case) -> list[list[float]]:
        with started(case) as host:
            return host.values(case)

    @contextmanager
    def timing(case: Case) -> Iterator[Callable[[int], float]]:
        with started(case) as host, host.timing(case) as seconds:
            yield seconds

    return values, timing


def numbers_of(case: Case) -> str:
    """The case as host.c reads it."""
    counts = [len(case.inputs), len(case.outputs), case.steps]
    lines = [f"{case.fmi} {_bits(case.step)}", " ".join(map(str, counts))]
    lines += [" ".join(map(str, case.references_of(names))) for names in (case.inputs, case.outputs)]
    lines += [" ".join(map(_bits, row)) for row in case.table]
    return "\n".join(lines) + "\n"


def _bits(value: float) -> str:
    return struct.pack(">d", value).hex()


def _value(bits: str) -> float:
    (value,) = struct.unpack(">d", bytes.fromhex(bits))
    return float(value)
