"""A run's output folder: what is in it, and when it may be written."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from pathlib import Path

from ..errors import MistakeError
from .atomic_write import partial
from .backup import Backup
from .run_state import clear, contents, find_run_state, format_path, lock_folder

CHECKPOINT = "checkpoint"
RESULT, CSV, UNITS, SCENARIO, SUMMARY, FIGURES = (
    "result.nc",
    "coupled.csv",
    "units.csv",
    "scenario.toml",
    "summary.json",
    "figures",
)


class OutputFolderError(MistakeError):
    """The output folder cannot take a result."""


def refuse_overwriting_source(source: Path, scenario: str, out: Path) -> None:
    """OutputFolderError if the result's own file, of text `scenario`, would replace another `source`."""
    target = out / SCENARIO
    if target.exists() and target.samefile(source) and source.read_text("utf-8") != scenario:
        raise OutputFolderError(
            f"{target}: is the scenario itself, which a result here would replace; choose another folder "
            "with --out"
        )


@dataclass(frozen=True)
class OutputFolder:
    """The folder of a run: `path`, the folder `find_run_state` in it, and the files that the run replaces."""

    path: Path
    unfinished: Path
    backup: Backup

    @property
    def checkpoint(self) -> Path:
        return self.unfinished / CHECKPOINT

    def discard(self) -> None:
        """Delete what the run has written."""
        clear(self.unfinished)
        for file in _list_written(self.path):
            file.unlink()


def check_folder(out: Path, overwrite: bool) -> None:
    """Raise OutputFolderError unless a run can write into `out`."""
    if out.exists() and not out.is_dir():
        raise OutputFolderError(f"{format_path(out)}: is a file; choose a folder with --out")
    if overwrite:
        return
    if find_run_state(out).exists() and (out / SCENARIO).exists():
        raise OutputFolderError(
            f"{format_path(out)}: holds a run that was not finished; continue it with tribocosim resume "
            f"{format_path(out)}, choose another folder with --out, or replace it with --overwrite"
        )
    _check_empty(out)


@contextmanager
def open_folder(out: Path, overwrite: bool) -> Iterator[OutputFolder]:
    """An empty output folder, locked for this process.

    With `overwrite` its files are put aside. They come back at the end of the block unless the run has had
    its first values and deleted the backup.
    """
    with ExitStack() as stack:
        try:
            folder = OutputFolder(out, stack.enter_context(lock_folder(out)), Backup(out))
            folder.backup.restore()  # what a process killed before its first values left
            if not overwrite:
                _check_empty(out)  # again: another process may have run since `check_folder`
            folder.backup.take([*_list_written(out), *contents(folder.unfinished)])
        except OSError as error:
            raise OutputFolderError(
                f"{format_path(out)}: cannot be written ({error.strerror}); choose another --out"
            ) from None
        try:
            yield folder
        finally:
            if folder.backup.exists:
                folder.discard()
                folder.backup.restore()


def files(out: Path) -> list[Path]:
    """What a run has written, in the order to be shown."""
    found = [out / name for name in (SUMMARY, RESULT, CSV, UNITS, SCENARIO)]
    return [path for path in [*found, *_figures(out)] if path.exists()]


def suggest_folder(path: Path) -> str | None:
    """The run's output folder that was probably meant by `path`, a file in it or the scenario's name."""
    folders = (path.parent, Path("results") / path.name)
    return next((str(folder) for folder in folders if (folder / SCENARIO).is_file()), None)


def _check_empty(out: Path) -> None:
    if held := _list_written(out):
        raise OutputFolderError(
            f"{format_path(out)}: already holds a result ({held[0].name}); choose another folder with --out, "
            "or replace it with --overwrite"
        )


def _list_written(out: Path) -> list[Path]:
    paths = [out / name for name in (RESULT, CSV, UNITS, SCENARIO, SUMMARY)]
    return [path for path in [*paths, *map(partial, paths), *_figures(out)] if path.exists()]


def _figures(out: Path) -> list[Path]:
    return sorted((out / FIGURES).glob("*.png"))
