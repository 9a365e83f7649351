"""FMUs that were built, kept in the user's cache folder until nobody has asked for them for a while.

A file's name has the digest of all that it is made of, so that it never is out of date; but every edit of the
code leaves the files of before behind. Whoever adds one deletes those.
"""

from __future__ import annotations

from pathlib import Path

from models import kept_files
from models.cache_folder import private_folder
from models.kept_files import use


def cached(name: str, digest: str) -> Path:
    """Where the FMU made of what has this digest is kept; OSError where no such folder can be used."""
    return private_folder("fmus") / f"{name}-{digest[:16]}.fmu"


def there(file: Path) -> bool:
    """Whether the file is there; then it is kept from now on."""
    use(file)
    return file.is_file()


def tidy(folder: Path) -> None:
    """Delete the FMUs (and what builds that were killed have left of them) not asked for of late."""
    kept_files.tidy([*folder.glob("*.fmu"), *folder.glob(".*.part")])
