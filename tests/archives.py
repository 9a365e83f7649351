"""Copies of archives with changed files."""

import zipfile
from collections.abc import Callable, Mapping
from pathlib import Path


def repack(source: Path, target: Path, change: Callable[[str, bytes], Mapping[str, bytes]]) -> Path:
    """The archive at `target` with what `change(name, content)` gives for each file of that at `source`:
    files by name, none where it is left out."""
    with zipfile.ZipFile(source) as old, zipfile.ZipFile(target, "w") as new:
        for name in old.namelist():
            for other, content in change(name, old.read(name)).items():
                new.writestr(other, content)
    return target


def replace_text(source: Path, target: Path, old: str, new: str, file: str = "modelDescription.xml") -> Path:
    """The archive with another text in one of its files."""

    def change(name: str, content: bytes) -> Mapping[str, bytes]:
        if name == file:
            assert old.encode() in content
            content = content.replace(old.encode(), new.encode())
        return {name: content}

    return repack(source, target, change)


def rename_files(source: Path, target: Path, old: str, new: str) -> Path:
    """The archive with `new` in the place of `old` in the names of its files."""
    return repack(source, target, lambda name, content: {name.replace(old, new): content})
