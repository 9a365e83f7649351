"""Checks of an FMU's archive without unpacking it: damage, entries that would leave it, what is missing.

No model needs them: they stand here because the packaging and the master share only this folder.
"""

import contextlib
import hashlib
import stat
import zipfile
from collections.abc import Mapping
from pathlib import Path, PurePosixPath, PureWindowsPath
from xml.etree import ElementTree

from models.core.errors import MistakeError

DESCRIPTION = "modelDescription.xml"

# More than any FMU here has by a factor of a hundred; a compressed bomb is refused before it is unpacked.
MAXIMUM_UNPACKED_BYTES = 2_000_000_000
MAXIMUM_ENTRIES = 100_000

_KINDS = {
    stat.S_IFLNK: "a symbolic link",
    stat.S_IFIFO: "a named pipe",
    stat.S_IFCHR: "a device",
    stat.S_IFBLK: "a device",
    stat.S_IFSOCK: "a socket",
}


class FmuFileError(MistakeError):
    """The file is not an FMU that can be read; the message says why in one line."""


def open_archive(path: Path) -> zipfile.ZipFile:
    """The archive, to be closed by the caller; FmuFileError if there is none."""
    if not path.is_file():
        raise FmuFileError(f"{path}: {'is a folder; give an .fmu file' if path.is_dir() else 'no such file'}")
    try:
        return zipfile.ZipFile(path)
    except (zipfile.BadZipFile, OSError) as error:
        with contextlib.suppress(OSError), path.open("rb") as file:
            if file.read(4) == b"PK\x03\x04":
                raise FmuFileError(
                    f"{path}: is cut off: it begins as a zip archive, but its end is missing, so not an FMU; "
                    "fetch or make it again"
                ) from None
        raise FmuFileError(f"{path}: not a zip archive, so not an FMU ({one_line(error)})") from None


def count_unpacked(archive: zipfile.ZipFile) -> int:
    """How many bytes the archive unpacks to."""
    return sum(entry.file_size for entry in archive.infolist())


def archive_faults(archive: zipfile.ZipFile) -> list[str]:
    """What `unpacking_faults` finds, and a description that is missing or of another version; a line each."""
    if faults := unpacking_faults(archive):
        return faults
    if DESCRIPTION not in archive.namelist():
        return [f"{DESCRIPTION} is missing, so this is not an FMU"]
    fault = _version_fault(archive.read(DESCRIPTION))
    return [fault] if fault else []


def unpacking_faults(archive: zipfile.ZipFile, room: int = MAXIMUM_UNPACKED_BYTES) -> list[str]:
    """Entries that would be unpacked elsewhere, and damage; a line each. `room` is how many bytes it may
    unpack to, with what it is a part of."""
    if len(archive.infolist()) > MAXIMUM_ENTRIES:
        return [f"{len(archive.infolist())} files: must be at most {MAXIMUM_ENTRIES}"]
    faults = [fault for entry in archive.infolist() if (fault := _entry_fault(entry))]
    faults += [f"{name}: is in the archive twice, with different content" for name in _ambiguous(archive)]
    unpacked = count_unpacked(archive)
    if unpacked > room:
        inside = "" if room == MAXIMUM_UNPACKED_BYTES else " with the package that it is in"
        limit = f"{MAXIMUM_UNPACKED_BYTES:.3g}{inside}"
        faults.append(f"{unpacked:.3g} bytes when unpacked: must be at most {limit}")
    if faults:
        return faults
    try:
        damaged = archive.testzip()
    except Exception as error:  # zlib, struct and others, depending on what is damaged
        return [f"damaged archive: {one_line(error)}"]
    if damaged:
        return [f"damaged archive: {damaged} does not match its checksum"]
    return []


def _ambiguous(archive: zipfile.ZipFile) -> list[str]:
    """The files of which there are several that differ."""
    contents: dict[str, set[tuple[int, int]]] = {}
    for entry in archive.infolist():
        if not entry.is_dir():
            contents.setdefault(entry.filename, set()).add((entry.CRC, entry.file_size))
    return sorted(name for name, found in contents.items() if len(found) > 1)


def compute_digest(files: Mapping[str, bytes]) -> str:
    """SHA-256 over names and contents."""
    digest = hashlib.sha256()
    for name, content in sorted(files.items()):
        digest.update(f"{name} {len(content)}\n".encode())
        digest.update(content)
    return digest.hexdigest()


def _version_fault(xml: bytes) -> str | None:
    """A description that says another version of FMI than it is written in; no library reads it."""
    try:
        root = ElementTree.fromstring(xml)
    except ElementTree.ParseError:
        return None  # whoever reads it says where
    said, written = root.get("fmiVersion", ""), _find_version(root)
    if not written or not said[:1].isdigit() or said[0] in (written[0], *"456789"):
        return None
    return (
        f"{DESCRIPTION}: says fmiVersion = {said!r}, but is written as FMI {written} has it; "
        "the tool that made it, or whoever changed it, has to mend it"
    )


def _find_version(root: ElementTree.Element) -> str | None:
    """The version of FMI whose elements and attributes these are; None where nothing tells."""
    variables = root.find("ModelVariables")
    kinds = {variable.tag for variable in variables} if variables is not None else set()
    if root.get("instantiationToken") is not None or kinds - {"ScalarVariable"}:
        return "3.0"
    if root.get("modelIdentifier") is not None or root.find("Implementation") is not None:
        return "1.0"
    return "2.0" if kinds else None


def _entry_fault(entry: zipfile.ZipInfo) -> str | None:
    name = entry.orig_filename
    path = PurePosixPath(name)
    if path.is_absolute() or ".." in path.parts or PureWindowsPath(name).drive or "\0" in name:
        return f"{name!r}: the path leaves the archive; not safe to unpack"
    if "\\" in name:
        return f"{name!r}: the path has a backslash; FMUs separate folders by /"
    mode = entry.external_attr >> 16
    if stat.S_IFMT(mode) not in (0, stat.S_IFREG, stat.S_IFDIR):
        kind = _KINDS.get(stat.S_IFMT(mode), "neither a file nor a folder")
        return f"{name!r}: is {kind}; not safe to unpack"
    if mode & (stat.S_ISUID | stat.S_ISGID) and not stat.S_ISDIR(mode):
        return f"{name!r}: would run with the rights of its owner; not safe to unpack"
    return None


def one_line(error: object) -> str:
    """The message of an error without line breaks."""
    return " ".join(str(error).split())
