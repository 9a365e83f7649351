"""Checks the shared libraries in an FMU: complete, for the right platform, with the standard's functions."""

import re
import zipfile
from functools import cache
from pathlib import Path, PurePosixPath

import fmpy
from fmpy.model_description import ModelDescription

from .fmi.libraries import ELF, MACH_O, PE, Library, LibraryError, libraries

HEADERS = Path(fmpy.__file__).parent / "c-code"
SUFFIXES = (".so", ".dll", ".dylib")
_OF_SYSTEM = {"linux": ELF, "windows": PE, "darwin": MACH_O}
# Of FMI 1.0 and 2.0; those of FMI 3.0 say processor and system. darwin64 is any Mac of 64 bits.
_PLATFORMS = {
    "win32": (PE, "x86"),
    "win64": (PE, "x86_64"),
    "linux32": (ELF, "x86"),
    "linux64": (ELF, "x86_64"),
    "darwin64": (MACH_O, "x86_64 or aarch64"),
}
_NAMED_AT_MOST = 3  # missing functions in a message


def binary_faults(archive: zipfile.ZipFile, described: ModelDescription) -> list[str]:
    """A line for each library that is wrong."""
    kinds = [described.coSimulation, described.modelExchange, described.scheduledExecution]
    models = {kind.modelIdentifier for kind in kinds if kind is not None}
    faults = []
    for name in archive.namelist():
        path = PurePosixPath(name)
        if not is_library(path):
            continue
        needed = _required_functions(described) if path.stem in models else frozenset()
        fault = library_fault(archive.read(name), path.parts[1], needed)
        faults += [f"{name}: {fault}"] if fault else []
    return faults


def is_library(path: PurePosixPath) -> bool:
    """Whether it is the path of a shared library for a platform."""
    return path.suffix in SUFFIXES and len(path.parts) == 3 and path.parts[0] == "binaries"


def library_fault(content: bytes, folder: str, needed: frozenset[str]) -> str:
    """What is wrong with a library in `folder` of `binaries` that must export the functions `needed`; "" if
    nothing is."""
    try:
        found = libraries(content)
    except LibraryError as error:
        return f"{error}; pack the FMU again, from the library as it was built"
    wanted = platform(folder)
    fitting = [one for one in found if wanted is None or _fits(one, *wanted)]
    if wanted and not fitting:
        is_for = ", ".join(f"{one.processor} ({one.format})" for one in found)
        return f"is for {is_for}: must be for {wanted[1]} ({wanted[0]}), by its folder's name"
    if missing := sorted(needed - frozenset.intersection(*(one.exports for one in fitting))):
        more = f" and {len(missing) - _NAMED_AT_MOST} more" if len(missing) > _NAMED_AT_MOST else ""
        named = ", ".join(missing[:_NAMED_AT_MOST])
        return f"does not export {named}{more}, which the standard asks for; it does not belong to this FMU"
    return ""


def platform(folder: str) -> tuple[str, str] | None:
    """Format and processor for a folder's name; None if the standard does not define it."""
    if folder in _PLATFORMS:
        return _PLATFORMS[folder]
    processor, _, system = folder.partition("-")
    form = _OF_SYSTEM.get(system.partition("-")[0])
    return (form, processor) if form else None


def _fits(library: Library, form: str, processors: str) -> bool:
    return library.format == form and library.processor in processors.split(" or ")


def _required_functions(described: ModelDescription) -> frozenset[str]:
    if described.fmiVersion == "2.0":
        return functions(2, described.modelExchange is not None, described.coSimulation is not None)
    return functions(3)


@cache
def functions(fmi: int, exchange: bool = True, simulation: bool = True) -> frozenset[str]:
    """All of the standard's headers; of FMI 2.0 those for the kinds that an FMU is, FMI 3.0 asks for all."""
    text = (HEADERS / f"fmi{fmi}Functions.h").read_text("utf-8")
    text = text[text.index("#define fmi2Version") :] if fmi == 2 else text  # after what renames them
    common, *own = re.split(r"Functions for FMI2 for (?:Model Exchange|Co-Simulation)", text)
    wanted = [common, *(part for part, used in zip(own, (exchange, simulation), strict=False) if used)]
    return frozenset(name for part in wanted for name in re.findall(r"Export \w+TYPE\s+(\w+);", part))
