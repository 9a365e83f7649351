"""The user's cache folder: derived files, some of which are run when they are read.

Like ssh with its keys, nothing is read from a folder that another user may have written.
"""

from __future__ import annotations

import errno
import os
import stat
import sys
from pathlib import Path

# Set to the message for processes that this one starts, which need not repeat it.
SAID = "TRIBOCOSIM_CACHE_REFUSED"


class UntrustedFolderError(OSError):
    """A cache folder that another user may have written."""


def user_cache_directory() -> Path:
    """Where this user's derived files go: $TRIBOCOSIM_CACHE or the platform's cache folder."""
    if chosen := os.environ.get("TRIBOCOSIM_CACHE"):
        return Path(chosen)
    if sys.platform == "win32":
        return Path(os.environ.get("LOCALAPPDATA", Path.home() / "AppData" / "Local")) / "tribocosim"
    if sys.platform == "darwin":
        return Path.home() / "Library" / "Caches" / "tribocosim"
    return Path(os.environ.get("XDG_CACHE_HOME", Path.home() / ".cache")) / "tribocosim"


def private_folder(name: str) -> Path:
    """The folder `name` in the user's cache folder, made if it isn't there, for this user alone (mode 0700).

    OSError if it cannot be made; UntrustedFolderError, and once a message on standard error, if it or the
    cache folder belongs to another user or others may write it. Windows, where a folder's mode does not say
    who may write it, is not checked.
    """
    top = user_cache_directory()
    for folder in (top, top / name):
        for missing in [place for place in (*reversed(folder.parents), folder) if not place.exists()]:
            missing.mkdir(mode=0o700, exist_ok=True)
        _check(folder.resolve())
    return folder


def _check(folder: Path) -> None:
    if not hasattr(os, "getuid"):
        return
    elsewhere = "set TRIBOCOSIM_CACHE to a folder of your own"
    found = folder.stat()
    if found.st_uid != os.getuid():
        raise _refusal(folder, "belongs to another user", elsewhere)
    if found.st_mode & (stat.S_IWGRP | stat.S_IWOTH):
        mode = stat.S_IMODE(found.st_mode)
        raise _refusal(folder, f"others may write it (mode {mode:o})", f"delete it, or {elsewhere}")
    for above in folder.parents:
        # Who may write a folder may put another in the place of one in it, unless the sticky bit is set.
        mode = above.stat().st_mode
        if mode & stat.S_IWOTH and not mode & stat.S_ISVTX:
            raise _refusal(above, "everyone may write it", elsewhere)


def _refusal(folder: Path, reason: str, remedy: str) -> UntrustedFolderError:
    message = f"tribocosim: works without a cache: {folder}: {reason}; {remedy}"
    if os.environ.get(SAID) != message:
        os.environ[SAID] = message
        print(message, file=sys.stderr)
    return UntrustedFolderError(errno.EACCES, reason, str(folder))
