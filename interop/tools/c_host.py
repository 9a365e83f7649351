"""A program in C (`interop/host.c`)."""

import tempfile
from pathlib import Path

from ..c_program import Host, compile_host, find_libpython
from ..case import Case, RefusedError

TITLE = "program in C"
REQUIREMENTS = ("fmpy", "ziglang")
USE = "[libpython3.x.so](../how-to/use-the-fmus.md#prepare-the-host) for FMUs in Python"


def version() -> str:
    from importlib.metadata import version

    if find_libpython() is None:
        raise RefusedError("this Python was built without a shared library, which a program would load")
    return f"zig {version('ziglang')}"


def values(case: Case) -> list[list[float]]:
    preload = str(find_libpython()) if case.python else "-"
    with tempfile.TemporaryDirectory() as folder:
        return Host(compile_host(Path(folder)), preload=preload).values(case)
