"""The program in C for Linux on ARM64, run by qemu."""

import shutil
import subprocess
import tempfile
from pathlib import Path

from ..c_program import Host, compile_host
from ..case import Case, RefusedError

TITLE = "program in C for ARM64, in qemu"
REQUIREMENTS = ("fmpy", "ziglang")
USE = "Debian's qemu-user and libc6-arm64-cross, or such a machine"
PLATFORM = "aarch64-linux"
FINDINGS = (
    "The difference of `ehl_contact` comes from glibc's `erfc` (load of asperities): on ARM64 one value of "
    "twenty has another last bit.",
)

LIBRARIES = "/usr/aarch64-linux-gnu"


def version() -> str:
    if shutil.which("qemu-aarch64") is None or not Path(LIBRARIES).is_dir():
        raise RefusedError("there is no qemu-aarch64 with libraries (Debian's qemu-user, libc6-arm64-cross)")
    said = subprocess.run(["qemu-aarch64", "--version"], capture_output=True, text=True, check=True).stdout
    return said.splitlines()[0].partition(" (")[0]


def values(case: Case) -> list[list[float]]:
    with tempfile.TemporaryDirectory() as folder:
        program = compile_host(Path(folder), "aarch64-linux-gnu.2.17")
        places = {2: PLATFORM, 3: PLATFORM}
        return Host(program, places, runner=["qemu-aarch64", "-L", LIBRARIES]).values(case)
