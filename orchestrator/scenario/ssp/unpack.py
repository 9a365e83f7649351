"""Unpacks SSP packages, with those inside of them, once into the user's cache folder."""

import hashlib
import shutil
import zipfile
from pathlib import Path

from fmus.fmi.archive import (
    MAXIMUM_UNPACKED_BYTES,
    FmuFileError,
    compute_digest,
    count_unpacked,
    open_archive,
    unpacking_faults,
)
from models.compile.cache_folder import PrivateFolder, open_folder, user_cache_directory
from models.compile.temporary import TemporaryFolder

from ..scenario import ScenarioError
from .names import UNPACKED

# How deep packages may be inside of packages.
DEEPEST = 3
# Files beside unpacked packages, with a checksum: a power cut may leave files empty.
SUM = ".sum"


def unpack_into_cache(path: Path) -> Path:
    """The folder with the package's files."""
    name = hashlib.sha256(path.read_bytes()).hexdigest()[:16]
    try:
        with open_folder("ssp") as cache:
            folder = cache.path / name
            if not _is_whole(cache, name):
                shutil.rmtree(folder, ignore_errors=True)
                with TemporaryFolder(cache.path) as made:
                    whole = made / "whole"
                    unpack(path, whole)
                    cache.write(f"{name}{SUM}", _sum_up(whole))
                    if not folder.is_dir():  # another process may have been faster
                        whole.rename(folder)
    except OSError as error:
        raise ScenarioError(
            f"{path}: {user_cache_directory()} cannot be used ({error.strerror}); set TRIBOCOSIM_CACHE to "
            "another folder"
        ) from None
    return folder


def _is_whole(cache: PrivateFolder, name: str) -> bool:
    """Whether the unpacked package has the content that it was unpacked with."""
    try:
        return cache.read(f"{name}{SUM}") == _sum_up(cache.path / name)
    except OSError:
        return False


def _sum_up(folder: Path) -> bytes:
    """The SHA-256 of all that is in an unpacked package."""
    files = {str(file.relative_to(folder)): file for file in folder.rglob("*") if file.is_file()}
    return compute_digest({name: file.read_bytes() for name, file in files.items()}).encode()


def unpack(path: Path, folder: Path) -> None:
    """Unpack a package and those in it, which may take together as much as one."""
    _unpack(path, folder, MAXIMUM_UNPACKED_BYTES, 0)


def _unpack(path: Path, folder: Path, room: int, depth: int) -> int:
    """Unpack into `room` bytes, and return how many are left."""
    if depth > DEEPEST:
        raise ScenarioError(
            f"{path.name}: packages inside of packages, more than {DEEPEST} deep; unpack them"
        )
    try:
        with open_archive(path) as archive:
            if faults := unpacking_faults(archive, room):
                raise ScenarioError(f"{path if depth == 0 else path.name}: {faults[0]}")
            # In a package that was cut off, the last list of files that is found is that of an FMU inside.
            if min((entry.header_offset for entry in archive.infolist()), default=0):
                raise ScenarioError(f"{path}: damaged archive: a part of it is missing; fetch it again")
            folder.mkdir(parents=True, exist_ok=True)
            archive.extractall(folder)
            room -= count_unpacked(archive)
        for inner in [file for file in sorted(folder.rglob("*.ssp")) if file.is_file()]:
            room = _unpack(inner, inner.with_name(inner.name + UNPACKED), room, depth + 1)
    except (FmuFileError, zipfile.BadZipFile) as error:
        raise ScenarioError(str(error).replace("so not an FMU", "so not an SSP")) from None
    return room
