"""Checks of a packaged FMU, ours or foreign, without unpacking or running it.

`validate` lists what is wrong, in one line each; an empty list means nothing was found. `info` says what
an FMU is.
"""

from __future__ import annotations

import hashlib
import stat
import zipfile
from dataclasses import dataclass
from pathlib import Path, PurePosixPath, PureWindowsPath
from xml.etree import ElementTree

from fmpy.model_description import read_model_description
from fmpy.validation import validate_fmu

# More than any FMU here has by a factor of a hundred; a compressed bomb is refused before it is unpacked.
MAXIMUM_UNPACKED_BYTES = 2_000_000_000

_DESCRIPTION = "modelDescription.xml"


class FmuFileError(ValueError):
    """The file is not an FMU that can be read; the message says why in one line."""


@dataclass(frozen=True)
class VariableInfo:
    """One line of the table of variables."""

    name: str
    kind: str
    causality: str
    variability: str
    unit: str
    start: str
    description: str


@dataclass(frozen=True)
class FmuInfo:
    """What an FMU says about itself, and its SHA-256."""

    path: Path
    name: str
    fmi_version: str
    kinds: tuple[str, ...]
    version: str
    guid: str
    author: str
    license: str
    tool: str
    description: str
    platforms: tuple[str, ...]
    digest: str
    variables: tuple[VariableInfo, ...]

    def __str__(self) -> str:
        """For reading: what it is, then a table of the variables."""
        head = {
            "file": self.path,
            "model": f"{self.name} {self.version}: {self.description}",
            "kind": f"FMI {self.fmi_version} for {', '.join(self.kinds)}",
            "platforms": ", ".join(self.platforms),
            "by": f"{self.author}, licence {self.license}, made with {self.tool}",
            "GUID": self.guid,
            "SHA-256": self.digest,
        }
        rows = [("variable", "type", "causality", "variability", "unit", "start", "description")]
        rows += [
            (v.name, v.kind, v.causality, v.variability, v.unit, v.start, v.description)
            for v in self.variables
        ]
        widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
        table = ("  ".join(map(str.ljust, row, widths)).rstrip() for row in rows)
        return "\n".join([*(f"{key:10} {value}" for key, value in head.items()), "", *table])


def validate(path: Path | str) -> list[str]:
    """What is wrong with the FMU at `path`: the archive first, then its content (fmpy's checks and ours)."""
    path = Path(path)
    try:
        with _opened(path) as archive:
            faults = _archive_faults(archive)
            if faults:
                return faults
            version = _fmi_version(archive)
            names = set(archive.namelist())
    except FmuFileError as error:
        return [str(error)]
    faults = [_one_line(problem) for problem in validate_fmu(str(path))]
    if version == "2.0" and not faults:
        faults += _content_faults(path, names)
    return faults


def info(path: Path | str) -> FmuInfo:
    """What the FMU at `path` is. FmuFileError with one line if it cannot be read."""
    path = Path(path)
    with _opened(path) as archive:
        if faults := _archive_faults(archive):
            raise FmuFileError(faults[0])
        _fmi_version(archive)
        parts = (PurePosixPath(name).parts for name in archive.namelist())
        platforms = tuple(sorted({p[1] for p in parts if len(p) > 2 and p[0] == "binaries"}))
    try:
        described = read_model_description(str(path), validate=False)
    except Exception as error:  # fmpy lets through whatever its XML libraries raise
        raise FmuFileError(f"{path}: {_DESCRIPTION} cannot be read: {_one_line(error)}") from None
    kinds = {"co-simulation": described.coSimulation, "model exchange": described.modelExchange}
    return FmuInfo(
        path=path,
        name=described.modelName,
        fmi_version=described.fmiVersion,
        kinds=tuple(name for name, kind in kinds.items() if kind is not None),
        version=described.version or "",
        guid=described.guid or "",
        author=described.author or "",
        license=described.license or "",
        tool=described.generationTool or "",
        description=described.description or "",
        platforms=platforms,
        digest=checksum(path),
        variables=tuple(
            VariableInfo(
                v.name,
                v.type,
                v.causality,
                v.variability or "",
                v.unit or "",
                "" if v.start is None else str(v.start),
                v.description or "",
            )
            for v in described.modelVariables
        ),
    )


def checksum(path: Path | str) -> str:
    """SHA-256 of the file, as scenarios and results name an FMU."""
    with Path(path).open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def _opened(path: Path) -> zipfile.ZipFile:
    if not path.is_file():
        raise FmuFileError(f"{path}: no such file")
    try:
        return zipfile.ZipFile(path)
    except (zipfile.BadZipFile, OSError) as error:
        raise FmuFileError(f"{path}: not a zip archive, so not an FMU ({_one_line(error)})") from None


def _archive_faults(archive: zipfile.ZipFile) -> list[str]:
    """Entries that would be unpacked elsewhere, damage, and what is missing."""
    faults = [fault for entry in archive.infolist() if (fault := _entry_fault(entry))]
    names = archive.namelist()
    faults += [
        f"{name}: is in the archive twice" for name in sorted({n for n in names if names.count(n) > 1})
    ]
    unpacked = sum(entry.file_size for entry in archive.infolist())
    if unpacked > MAXIMUM_UNPACKED_BYTES:
        faults.append(f"{unpacked:.3g} bytes when unpacked: must be at most {MAXIMUM_UNPACKED_BYTES:.3g}")
    if faults:
        return faults
    try:
        damaged = archive.testzip()
    except Exception as error:  # zlib, struct and others, depending on what is damaged
        return [f"damaged archive: {_one_line(error)}"]
    if damaged:
        return [f"damaged archive: {damaged} does not match its checksum"]
    if _DESCRIPTION not in names:
        return [f"{_DESCRIPTION} is missing, so this is not an FMU"]
    return []


def _entry_fault(entry: zipfile.ZipInfo) -> str | None:
    name = entry.orig_filename
    path = PurePosixPath(name)
    if path.is_absolute() or ".." in path.parts or PureWindowsPath(name).drive or "\0" in name:
        return f"{name!r}: the path leaves the archive; the FMU is not safe to unpack"
    if "\\" in name:
        return f"{name!r}: the path has a backslash; FMUs separate folders by /"
    if stat.S_ISLNK(entry.external_attr >> 16):
        return f"{name!r}: is a symbolic link; the FMU is not safe to unpack"
    return None


def _fmi_version(archive: zipfile.ZipFile) -> str:
    try:
        root = ElementTree.fromstring(archive.read(_DESCRIPTION))
    except ElementTree.ParseError as error:
        raise FmuFileError(f"{_DESCRIPTION}: not XML: {_one_line(error)}") from None
    version = root.get("fmiVersion", "")
    if root.tag != "fmiModelDescription" or not version:
        raise FmuFileError(f"{_DESCRIPTION}: is not a model description (root element {root.tag!r})")
    if version not in ("1.0", "2.0") and not version.startswith("3."):
        raise FmuFileError(f"{_DESCRIPTION}: fmiVersion = {version!r}: must be 1.0, 2.0 or 3.x")
    return version


def _content_faults(path: Path, names: set[str]) -> list[str]:
    """What the standard asks for and the schema cannot say."""
    described = read_model_description(str(path), validate=False)
    faults = []
    slave = described.coSimulation or described.modelExchange
    if slave is None:
        return [f"{_DESCRIPTION}: neither co-simulation nor model exchange"]
    binaries = [name for name in names if name.startswith("binaries/") and not name.endswith("/")]
    stems = {PurePosixPath(name).stem for name in binaries}
    sources = any(name.startswith("sources/") for name in names)
    if not sources and slave.modelIdentifier not in stems:
        faults.append(f"binaries: none is called {slave.modelIdentifier}, the model identifier")
    for variable in described.modelVariables:
        if variable.type == "Real" and variable.start is not None:
            faults += _range_faults(variable)
    return faults


def _range_faults(variable) -> list[str]:
    start = float(variable.start)
    low = -float("inf") if variable.min is None else float(variable.min)
    high = float("inf") if variable.max is None else float(variable.max)
    if low <= start <= high:
        return []
    return [f"{variable.name}: start = {start:g} is outside [{low:g}, {high:g}]"]


def _one_line(error: object) -> str:
    return " ".join(str(error).split())
