"""Replace a file as a whole: after a kill at any moment it is the old one or the new one."""

import contextlib
import errno
import os
import re
import shutil
from collections.abc import Iterator
from pathlib import Path

# What is said where there is no room for what is written: on the disk, in the user's quota, for the process.
NO_ROOM = tuple(map(os.strerror, (errno.ENOSPC, errno.EDQUOT, errno.EFBIG)))


def write_whole(path: Path, content: bytes) -> None:
    """Give the file this content, down to the disk."""
    new = partial(path)
    try:
        with naming(path), new.open("wb") as file:
            file.write(content)
            file.flush()
            os.fsync(file.fileno())
    except OSError:
        new.unlink(missing_ok=True)  # it takes room and is of no use
        raise
    os.replace(new, path)
    # The name as well; on Windows a folder cannot be opened.
    with contextlib.suppress(PermissionError):
        folder = os.open(path.parent, os.O_RDONLY)
        try:
            os.fsync(folder)
        finally:
            os.close(folder)


@contextlib.contextmanager
def naming(path: Path) -> Iterator[None]:
    """An error of writing or of HDF5 in the block becomes an OSError that names the file."""
    try:
        yield
    except (OSError, RuntimeError) as error:
        # HDF5 has the number in its words, in errors of several kinds.
        said = re.search(r"errno = (\d+)", str(error))
        number = getattr(error, "errno", None) or (said and int(said[1]))
        if number is None:
            raise
        raise OSError(number, os.strerror(number), str(path)) from error


def check_room(path: Path, size: int) -> None:
    """OSError, as of writing, if the disk has no room for `size` bytes of the file.

    For those who cannot fail in the midst of it: HDF5 ends the process when it has to close a file whose
    data it could not write.
    """
    if shutil.disk_usage(path.parent).free < size:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC), str(path))


def partial(path: Path) -> Path:
    """The name of what is not whole yet."""
    return path.with_name(f"{path.name}.partial")
