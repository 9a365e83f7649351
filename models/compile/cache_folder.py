"""The user's cache folder: derived files, some of which are run when they are read.

As ssh does with its keys, nothing is read from a folder that another user may have written, nor below one in
which he could put another in its place. Folders are opened one below the other and checked while they are
held open, and files are opened relative to their folder: what is checked is what is read.
"""

import contextlib
import errno
import os
import stat
import sys
import uuid
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

# Set to the message for processes that this one starts, which need not repeat it.
SAID = "TRIBOCOSIM_CACHE_REFUSED"
ELSEWHERE = "set TRIBOCOSIM_CACHE to a folder of your own"
OTHERS_WRITE = stat.S_IWGRP | stat.S_IWOTH
# O_PATH needs no permission to list the folder; it exists on Linux only.
FOLDER_FLAGS = (
    getattr(os, "O_PATH", os.O_RDONLY) | getattr(os, "O_DIRECTORY", 0) | getattr(os, "O_NOFOLLOW", 0)
)
READ_FLAGS = (
    os.O_RDONLY | getattr(os, "O_NOFOLLOW", 0) | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_BINARY", 0)
)
NEW_FLAGS = os.O_WRONLY | os.O_CREAT | os.O_EXCL | getattr(os, "O_BINARY", 0)


class UntrustedFolderError(OSError):
    """A cache folder, or a file in it, that another user may have written."""


def user_cache_directory() -> Path:
    """Where this user's derived files go: $TRIBOCOSIM_CACHE or the platform's cache folder."""
    if chosen := os.environ.get("TRIBOCOSIM_CACHE"):
        return Path(chosen)
    if sys.platform == "win32":
        return Path(os.environ.get("LOCALAPPDATA", Path.home() / "AppData" / "Local")) / "tribocosim"
    if sys.platform == "darwin":
        return Path.home() / "Library" / "Caches" / "tribocosim"
    return Path(os.environ.get("XDG_CACHE_HOME", Path.home() / ".cache")) / "tribocosim"


@dataclass(frozen=True)
class PrivateFolder:
    """A checked folder. `handle` is open while the folder is in use, so that no other takes its place; None
    on Windows, where a folder's mode does not say who may write it and nothing is checked."""

    path: Path
    handle: int | None

    def read(self, name: str) -> bytes:
        """The content of a file of this user's; OSError if there is none, UntrustedFolderError otherwise."""
        with os.fdopen(os.open(self._place(name), READ_FLAGS, dir_fd=self.handle), "rb") as file:
            if self.handle is not None:
                self._check_file(name, os.fstat(file.fileno()))
            return file.read()

    def write(self, name: str, content: bytes) -> None:
        """Give the file this content, whole or not at all."""
        new = f"{name}.{uuid.uuid4().hex[:16]}"
        try:
            with os.fdopen(os.open(self._place(new), NEW_FLAGS, 0o600, dir_fd=self.handle), "wb") as file:
                file.write(content)
            os.replace(self._place(new), self._place(name), src_dir_fd=self.handle, dst_dir_fd=self.handle)
        except OSError:
            with contextlib.suppress(OSError):
                os.unlink(self._place(new), dir_fd=self.handle)
            raise

    def check_files(self) -> None:
        """UntrustedFolderError for a file in it that another user may have written: for those who read it by
        themselves."""
        for name in os.listdir(self.path) if self.handle is not None else ():
            self._check_file(name, os.stat(name, dir_fd=self.handle, follow_symlinks=False))

    def _place(self, name: str) -> str | Path:
        return name if self.handle is not None else self.path / name

    def _check_file(self, name: str, found: os.stat_result) -> None:
        if found.st_uid != os.getuid() or found.st_mode & OTHERS_WRITE or not stat.S_ISREG(found.st_mode):
            raise UntrustedFolderError(errno.EACCES, "others may have written it", str(self.path / name))


@contextlib.contextmanager
def open_folder(name: str) -> Iterator[PrivateFolder]:
    """The folder `name` in the user's cache folder, made if it isn't there, for this user alone (mode 0700).

    OSError if it cannot be made; UntrustedFolderError, and once a message on standard error, if it or the
    cache folder belongs to another user or others may write it, or if another user could put others in their
    places.
    """
    top = user_cache_directory()
    folder = top / name
    if not hasattr(os, "getuid"):
        folder.mkdir(parents=True, exist_ok=True)
        yield PrivateFolder(folder, None)
        return
    handle = _walk(folder.resolve(), top.resolve())
    try:
        yield PrivateFolder(folder, handle)
    finally:
        os.close(handle)


def private_folder(name: str) -> Path:
    """The path of `open_folder(name)`, for what cannot be read relative to a handle."""
    with open_folder(name) as folder:
        return folder.path


def _walk(folder: Path, top: Path) -> int:
    """A handle of the folder; each on the way is checked, and made if it isn't there."""
    handle = os.open(folder.anchor, FOLDER_FLAGS)
    try:
        for place in (*reversed(folder.parents), folder):
            if place != place.parent:
                above, handle = handle, _enter(place.name, handle)
                os.close(above)
            _check(place, os.fstat(handle), within=place.is_relative_to(top))
    except BaseException:
        os.close(handle)
        raise
    return handle


def _enter(name: str, above: int) -> int:
    with contextlib.suppress(FileNotFoundError):
        return os.open(name, FOLDER_FLAGS, dir_fd=above)
    with contextlib.suppress(FileExistsError):  # another process was faster
        os.mkdir(name, 0o700, dir_fd=above)
    return os.open(name, FOLDER_FLAGS, dir_fd=above)


def _check(place: Path, found: os.stat_result, within: bool) -> None:
    """Whoever may write a folder may put another in the place of one in it, unless the sticky bit is set."""
    mode = stat.S_IMODE(found.st_mode)
    if found.st_uid not in ((os.getuid(),) if within else (os.getuid(), 0)):
        raise _refusal(place, "belongs to another user", ELSEWHERE)
    if mode & OTHERS_WRITE and (within or not mode & stat.S_ISVTX):
        remedy = f"{'delete it' if within else f'run chmod go-w {place}'}, or {ELSEWHERE}"
        raise _refusal(place, f"others may write it (mode {mode:o})", remedy)


def _refusal(folder: Path, reason: str, remedy: str) -> UntrustedFolderError:
    message = f"tribocosim: works without a cache: {folder}: {reason}; {remedy}"
    if os.environ.get(SAID) != message:
        os.environ[SAID] = message
        print(message, file=sys.stderr)
    return UntrustedFolderError(errno.EACCES, reason, str(folder))
