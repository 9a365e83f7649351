"""FMUs from Python: of the catalogue's components and of a user's own."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

from orchestrator.command_line.fmu import build_file, check_options


def build_fmu(
    component: str,
    out: str | Path = ".",
    *,
    structure: Mapping[str, int] | None = None,
    native: bool = False,
    platforms: Sequence[str] = (),
    fmi: int = 2,
) -> Path:
    """Build an FMU in the folder `out`, as the command `fmu build` does; the path of its file.

    `component` is a name of the catalogue, or a user's own as "module:factory". `structure` has sizes such as
    {"coil_masses": 8}. A `native` FMU is machine code for the `platforms` (default: all), of `fmi` 2 or 3;
    others run in Python, of FMI 2. MistakeError says what is wrong.
    """
    sizes = [f"{name}={size}" for name, size in (structure or {}).items()]
    check_options([component], sizes, native, list(platforms) or None, fmi, None)
    return build_file(component, Path(out), structure, native, list(platforms) or None, fmi)
