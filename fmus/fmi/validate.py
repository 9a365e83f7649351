"""Checks of a packaged FMU, ours or third-party, without unpacking or running it.

`inspect` tells what keeps an FMU from running here, and what else departs from the standard, in one line
each; `validate` lists both. `info` says what an FMU is.
"""

import hashlib
import re
import shutil
import textwrap
import zipfile
from collections.abc import Collection, Iterator, Sequence
from dataclasses import astuple, dataclass, replace
from pathlib import Path, PurePosixPath
from typing import Any
from xml.etree import ElementTree

import fmpy
from fmpy.model_description import ModelDescription, read_model_description
from fmpy.validation import validate_fmu
from lxml import etree

from fmus.fmi.archive import DESCRIPTION, FmuFileError, archive_faults, one_line, open_archive
from models.core.errors import group_elements

from ..binaries import binary_faults, is_library

TERMINALS = "terminalsAndIcons/terminalsAndIcons.xml"
# What a master may make use of, by the standard's names.
CAPABILITIES = (
    "canHandleVariableCommunicationStepSize", "canGetAndSetFMUstate", "canSerializeFMUstate",
    "providesDirectionalDerivative", "providesDirectionalDerivatives", "canInterpolateInputs",
    "hasEventMode", "canBeInstantiatedOnlyOncePerProcess",
)  # fmt: skip
ORDER = "maxOutputDerivativeOrder"
# An array with more elements is shown as a table: one line, after all else.
FEW = 8
# Columns that a description needs beside its variable.
LEAST_ROOM = 30


@dataclass(frozen=True)
class VariableInfo:
    """One line of the table of variables."""

    name: str
    kind: str
    causality: str
    variability: str
    unit: str
    start: str
    range: str
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
    capabilities: tuple[str, ...]
    platforms: tuple[str, ...]
    digest: str
    variables: tuple[VariableInfo, ...]

    def __str__(self) -> str:
        """For reading: what it is, then a table of the variables."""
        head = {
            "file": self.path,
            "model": " ".join(filter(None, (self.name, self.version)))
            + (f": {self.description}" if self.description else ""),
            "kind": f"FMI {self.fmi_version} for {', '.join(self.kinds)}",
            "platforms": ", ".join(self.platforms),
            "can": ", ".join(self.capabilities),
            "by": ", ".join(
                word + text
                for word, text in (("", self.author), ("licence ", self.license), ("made with ", self.tool))
                if text
            ),
            "GUID": self.guid,
            "SHA-256": self.digest,
        }
        columns = shutil.get_terminal_size((120, 0)).columns
        lines = [_wrap(f"{key:10} ", str(value), columns) for key, value in head.items() if value]
        return "\n".join([*lines, "", *_tabulate(self.variables, columns)])


def _tabulate(variables: Sequence[VariableInfo], columns: int) -> Iterator[str]:
    """A line for each, with its description where there is room, else below it."""
    rows: list[tuple[str, ...]] = [
        ("variable", "type", "causality", "variability", "unit", "start", "range", "description")
    ]
    rows += _list_rows(variables)
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)][:-1]
    for row in rows:
        line = "  ".join(map(str.ljust, row[:-1], widths)) + "  "
        if len(line) + LEAST_ROOM <= columns:
            yield _wrap(line, row[-1], columns)
        else:
            yield line.rstrip()
            if row[-1]:
                yield _wrap("    ", row[-1], columns)


def _wrap(begin: str, text: str, columns: int) -> str:
    """A text behind a beginning, in lines of so many columns."""
    room = max(LEAST_ROOM, columns - len(begin))
    lines = textwrap.wrap(text, room, break_long_words=False, break_on_hyphens=False) or [""]
    return f"\n{' ' * len(begin)}".join([begin + lines[0], *lines[1:]]).rstrip()


def _round(text: str) -> str:
    """The numbers of a start or range with six digits."""
    return re.sub(r"-?\d+\.\d+(e[-+]?\d+)?", lambda found: f"{float(found[0]):g}", text)


def _list_rows(variables: Sequence[VariableInfo]) -> list[tuple[str, ...]]:
    """A row for each, and at the end one for each table: an array of more than FEW elements."""
    known = {v.name: v for v in variables}
    tables = {name: every for name, every in group_elements(known).items() if len(every) > FEW}
    folded = {name for every in tables.values() for name in every}
    shown = [v for v in variables if v.name not in folded]
    for name, (first, *_, last) in tables.items():
        starts = dict.fromkeys((known[first].start, known[last].start))
        shown.append(replace(known[first], name=name, start=" ... ".join(starts)))
    rounded = (
        v if v.kind == "String" else replace(v, start=_round(v.start), range=_round(v.range)) for v in shown
    )
    return [astuple(v) for v in rounded]


@dataclass(frozen=True)
class Findings:
    """What keeps an FMU from running on this machine, and what else departs from the standard."""

    faults: list[str]
    remarks: list[str]

    def __bool__(self) -> bool:
        return bool(self.faults or self.remarks)

    def __str__(self) -> str:
        if not self:
            return "no problems found"
        parts = (("cannot run here:", self.faults), ("departs from the standard:", self.remarks))
        return "\n".join("\n  ".join([head, *lines]) for head, lines in parts if lines)


def validate(path: Path | str) -> list[str]:
    """All that is wrong with the FMU at `path`."""
    found = inspect(path)
    return found.faults + found.remarks


def inspect(path: Path | str) -> Findings:
    """What is wrong with the FMU at `path`: the archive first, then its content (fmpy's checks and ours)."""
    path = Path(path)
    try:
        with open_archive(path) as archive:
            faults = archive_faults(archive)
            if faults:
                return Findings(faults, [])
            version = _fmi_version(archive)
            names = set(archive.namelist())
            terminals = archive.read(TERMINALS) if TERMINALS in names else b""
    except FmuFileError as error:
        return Findings([str(error)], [])
    departures = [one_line(problem) for problem in validate_fmu(str(path))]
    try:
        described = read_model_description(str(path), validate=False)
    except Exception as error:  # fmpy lets through whatever its XML libraries raise
        return Findings(departures or [f"{DESCRIPTION} cannot be read: {one_line(error)}"], [])
    if version == "1.0":
        return Findings([], departures)
    slave = described.coSimulation or described.modelExchange or described.scheduledExecution
    if slave is None:
        return Findings([f"{DESCRIPTION}: neither co-simulation nor model exchange"], departures)
    with open_archive(path) as archive:
        libraries = [*_name_faults(slave.modelIdentifier, names), *binary_faults(archive, described)]
    faults = [line for line in libraries if _is_here(line)]
    departures += [line for line in libraries if line not in faults]
    if not departures:  # what else is checked asks for a description in order
        departures += [fault for variable in described.modelVariables for fault in _range_faults(variable)]
        if terminals:
            departures += terminal_faults(terminals, {v.name for v in described.modelVariables})
    return Findings(faults, departures)


def _is_here(fault: str) -> bool:
    """Whether it is of the libraries of this platform, or of all."""
    place = PurePosixPath(fault.partition(":")[0]).parts
    return len(place) < 2 or place[1] in (fmpy.platform, fmpy.platform_tuple)


def terminal_faults(xml: bytes, variables: Collection[str]) -> list[str]:
    """What is wrong with terminalsAndIcons.xml of an FMU with these variables: the schema's word first."""
    folder = Path(fmpy.__file__).parent / "schema" / "fmi3"
    schema = etree.XMLSchema(file=str(folder / "fmi3TerminalsAndIcons.xsd"))
    try:
        root = etree.fromstring(xml)
    except etree.XMLSyntaxError as error:
        return [f"{TERMINALS}: not XML: {one_line(error)}"]
    if not schema.validate(root):
        return [f"{TERMINALS}: line {e.line}: {one_line(e.message)}" for e in schema.error_log]
    faults = []
    for terminal in root.iter("Terminal"):
        name, members = terminal.get("name"), terminal.findall("TerminalMemberVariable")
        for member in members:
            variable = member.get("variableName")
            if variable not in variables:
                faults.append(f"{TERMINALS}: terminal {name}: there is no variable {variable}")
        called = [member.get("memberName") for member in members]
        if terminal.get("matchingRule") in ("plug", "bus") and len({*called, None}) <= len(called):
            faults.append(f"{TERMINALS}: terminal {name}: members need names of their own")
    return faults


def read_sound_description(path: Path) -> ModelDescription:
    """The model description of an FMU whose archive has no faults. FmuFileError with one line otherwise."""
    with open_archive(path) as archive:
        if faults := archive_faults(archive):
            raise FmuFileError(f"{path}: {faults[0]}")
        _fmi_version(archive)
    try:
        return read_model_description(str(path), validate=False)
    except Exception as error:  # fmpy lets through whatever its XML libraries raise
        raise FmuFileError(f"{path}: {DESCRIPTION} cannot be read: {one_line(error)}") from None


def info(path: Path | str) -> FmuInfo:
    """What the FMU at `path` is. FmuFileError with one line if it cannot be read."""
    path = Path(path)
    described = read_sound_description(path)
    with open_archive(path) as archive:
        parts = (PurePosixPath(name).parts for name in archive.namelist())
        platforms = tuple(sorted({p[1] for p in parts if len(p) > 2 and p[0] == "binaries"}))
    kinds = {"co-simulation": described.coSimulation, "model exchange": described.modelExchange}
    kinds["scheduled execution"] = described.scheduledExecution
    return FmuInfo(
        path=path,
        name=described.modelName,
        fmi_version=described.fmiVersion,
        kinds=tuple(name for name, kind in kinds.items() if kind is not None),
        capabilities=_list_capabilities(described),
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
                v.unit or getattr(v.declaredType, "unit", None) or "",
                "" if v.start is None else str(v.start),
                _range(v),
                _meaning(v),
            )
            for v in described.modelVariables
        ),
    )


def _list_capabilities(described: Any) -> tuple[str, ...]:
    """What the interfaces of a model description say that they can, by the standard's names."""
    interfaces = [one for one in (described.coSimulation, described.modelExchange) if one is not None]
    found = [key for key in CAPABILITIES if any(getattr(one, key, False) for one in interfaces)]
    order = max((getattr(one, ORDER, None) or 0 for one in interfaces), default=0)
    return (*found, *[f"{ORDER} = {order}"] * (order > 0))


def _range(variable: Any) -> str:
    """From the least to the largest value, each where it is stated."""
    least, most = (
        getattr(variable, key) or getattr(variable.declaredType, key, None) or "" for key in ("min", "max")
    )
    return f"{least}..{most}" if least or most else ""


def _meaning(variable: Any) -> str:
    """The description; of an enumeration its items, too."""
    items = getattr(variable.declaredType, "items", None) if variable.type == "Enumeration" else None
    named = ", ".join(f"{item.name} = {item.value}" for item in items or ())
    return " ".join(filter(None, (variable.description, f"({named})" if named else "")))


def checksum(path: Path | str) -> str:
    """SHA-256 of the file, as scenarios and results name an FMU."""
    with Path(path).open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def _fmi_version(archive: zipfile.ZipFile) -> str:
    try:
        root = ElementTree.fromstring(archive.read(DESCRIPTION))
    except ElementTree.ParseError as error:
        raise FmuFileError(f"{DESCRIPTION}: not XML: {one_line(error)}") from None
    version = root.get("fmiVersion", "")
    if root.tag != "fmiModelDescription" or not version:
        raise FmuFileError(f"{DESCRIPTION}: is not a model description (root element {root.tag!r})")
    if version not in ("1.0", "2.0") and not version.startswith("3."):
        raise FmuFileError(f"{DESCRIPTION}: fmiVersion = {version!r}: must be 1.0, 2.0 or 3.x")
    return version


def _name_faults(identifier: str, names: set[str]) -> list[str]:
    """Where no library has the name that the standard asks for."""
    faults = []
    stems: dict[str, set[str]] = {}
    for path in filter(is_library, map(PurePosixPath, names)):
        stems.setdefault(path.parts[1], set()).add(path.stem)
    sources = any(name.startswith("sources/") for name in names)
    if not sources and not stems:
        faults.append(f"binaries: none is called {identifier}, the model identifier")
    for folder, found in sorted(stems.items()):
        if identifier not in found:
            faults.append(
                f"binaries/{folder}: none is called {identifier}, the model identifier, but "
                f"{', '.join(sorted(found))}"
            )
    return faults


def _range_faults(variable: Any) -> list[str]:
    """Of a number that starts outside of its range, which the schema cannot say."""
    if variable.type not in ("Real", "Float64") or variable.start is None or variable.dimensions:
        return []
    start = float(variable.start)
    low = -float("inf") if variable.min is None else float(variable.min)
    high = float("inf") if variable.max is None else float(variable.max)
    if low <= start <= high:
        return []
    return [f"{variable.name}: start = {start:g} is outside [{low:g}, {high:g}]"]
