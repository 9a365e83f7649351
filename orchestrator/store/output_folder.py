"""A run's output folder: its files, the folder of an unfinished run, its lock, and the files it replaces.

The folder `unfinished` holds the journals and the last checkpoint, from which a run can be resumed. It is
locked while a process works on the run, and removed when the result is whole.
"""

import difflib
import os
import shutil
from collections.abc import Iterable, Iterator
from contextlib import ExitStack, contextmanager, suppress
from dataclasses import dataclass
from errno import EACCES
from pathlib import Path

import locket

from ..errors import REPLACE, Command, MistakeError, another
from ..texts import parse_toml, read_text
from .atomic_write import partial

UNFINISHED, LOCK, CHECKPOINT = "unfinished", "lock", "checkpoint"
# Of a sweep over speed, instead of a run; the last one is its scenario.
STORE, CYCLES, SWEPT = "speeds.zarr", "cycles.nc", "swept.toml"
REPLACED = "replaced"  # files of an earlier run, put aside until this one has its first values
RESULT, CSV, UNITS, SCENARIO = "result.nc", "coupled.csv", "units.csv", "scenario.toml"
SUMMARY, REPORT, PRINTED, TEXTS = "summary.json", "report.html", "printed.log", "texts.csv"
MERITS = "summary.csv"
# What a run writes, in the order to be shown, and its figures.
WRITTEN, FIGURES = (REPORT, SUMMARY, MERITS, RESULT, CSV, UNITS, TEXTS, SCENARIO, PRINTED), "figures"


class OutputFolderError(MistakeError):
    """The output folder cannot take a result."""


def refuse_unwritable(path: Path, error: OSError, option: str = "out") -> OutputFolderError:
    """The error of a path, given by `option`, that cannot be written."""
    return OutputFolderError(f"{path}: cannot be written ({error.strerror or error})", another(option))


@contextmanager
def writing(path: Path, option: str = "out") -> Iterator[None]:
    """OutputFolderError if the block cannot write to the path that was given by `option`."""
    try:
        yield
    except OSError as error:
        raise refuse_unwritable(path, error, option) from None


def refuse_overwriting_source(source: Path, scenario: str, out: Path) -> None:
    """OutputFolderError if the result's own file, of text `scenario`, would replace another `source`."""
    target = out / SCENARIO
    if target.exists() and target.samefile(source) and source.read_text("utf-8") != scenario:
        raise OutputFolderError(
            f"{target}: is the scenario itself, which a result here would replace", another()
        )


class Backup:
    """Files of `out`, moved to a folder in there: no room is taken, and after a kill the next run finds
    them."""

    def __init__(self, out: Path) -> None:
        self._out = out
        self._folder = out / REPLACED

    @property
    def exists(self) -> bool:
        return self._folder.is_dir()

    def take(self, files: Iterable[Path]) -> None:
        """Move these files of `out` there."""
        for file in files:
            place = self._folder / file.relative_to(self._out)
            place.parent.mkdir(parents=True, exist_ok=True)
            os.replace(file, place)

    def restore(self) -> None:
        """Move all files back."""
        for file in [path for path in self._folder.rglob("*") if path.is_file()]:
            place = self._out / file.relative_to(self._folder)
            place.parent.mkdir(exist_ok=True)
            os.replace(file, place)
        self.delete()

    def delete(self) -> None:
        shutil.rmtree(self._folder, ignore_errors=True)


@dataclass(frozen=True)
class OutputFolder:
    """The folder of a run, the folder `unfinished` in it, and the files that the run replaces."""

    path: Path
    unfinished: Path
    backup: Backup

    @property
    def checkpoint(self) -> Path:
        return self.unfinished / CHECKPOINT

    def discard(self) -> None:
        """Delete what the run has written."""
        clear_run_state(self.unfinished)
        for file in _list_written(self.path):
            file.unlink()


def refuse_file(out: Path) -> None:
    """Raise OutputFolderError if a file stands in the place of an output folder, or of one around it."""
    for folder in (out, *out.parents):
        if folder.exists() and not folder.is_dir():
            raise OutputFolderError(f"{format_path(folder)}: is a file", another())


def make_folder(out: Path) -> list[Path]:
    """The folders made for `out`, the innermost first; OutputFolderError if it cannot be written."""
    missing = [path for path in (out, *out.parents) if not path.exists()]
    try:
        out.mkdir(parents=True, exist_ok=True)
    except FileNotFoundError:  # as Linux says of a folder of its own, such as /proc
        around = format_path(missing[-1].parent)
        raise OutputFolderError(f"{format_path(out)}: no folder can be made in {around}", another()) from None
    except OSError as error:
        raise refuse_unwritable(format_path(out), error) from None
    if not os.access(out, os.W_OK):
        raise refuse_unwritable(format_path(out), PermissionError(EACCES, os.strerror(EACCES)))
    return missing


def remove_empty(folders: Iterable[Path]) -> None:
    """Up to the first one that is not."""
    with suppress(OSError):
        for path in folders:
            path.rmdir()


def check_folder(out: Path, overwrite: bool) -> None:
    """Raise OutputFolderError unless a run can write into `out`."""
    refuse_file(out)
    remove_empty(make_folder(out))
    if overwrite:
        return
    if find_run_state(out).exists() and (out / SCENARIO).exists():
        raise OutputFolderError(
            f"{format_path(out)}: holds a run that was not finished",
            ("continue it with ", Command("resume", (format_path(out),))),
            another(),
            REPLACE,
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
            folder.backup.take([*_list_written(out), *list_run_state(folder.unfinished)])
        except OSError as error:
            raise refuse_unwritable(format_path(out), error) from None
        try:
            yield folder
        finally:
            if folder.backup.exists:
                folder.discard()
                folder.backup.restore()


def is_run(folder: Path) -> bool:
    """Whether a run left its result there."""
    return (folder / RESULT).is_file()


def list_files(out: Path) -> list[Path]:
    """What a run has written, in the order to be shown."""
    figures = sorted((out / FIGURES).glob("*.png"))
    return [path for path in [*(out / name for name in WRITTEN), *figures] if path.exists()]


def check_swept(folder: Path) -> None:
    """MistakeError unless the sweep in the folder ended with cycles over angle and speed."""
    if not (folder / SUMMARY).is_file():
        raise MistakeError(f"{folder}: its sweep broke off; the same command continues it")
    if not (folder / CYCLES).is_file():
        raise MistakeError(f"{folder}: has no {CYCLES}; a report needs the cycles of two speeds at least")


def refuse_missing(folder: Path) -> None:
    """MistakeError if there is nothing of that name."""
    if not folder.exists():
        remedy = find_remedy(folder, "give the output folder of a run, or of a sweep")
        raise MistakeError(f"{folder}: there is no such folder; {remedy}")


def find_remedy(path: Path, otherwise: str) -> str:
    """Whether another run's output folder was meant by `path`, in words; `otherwise` where there is none."""
    close = suggest_folder(path)
    return f"did you mean {close}?" if close else otherwise


def suggest_folder(path: Path) -> str | None:
    """The run's output folder that was probably meant by `path`, a file in it or the scenario's name."""
    beside = {
        folder.name: folder for parent in (Path("results"), path.parent) for folder in _list_runs(parent)
    }
    close = difflib.get_close_matches(path.name, [name for name in beside if beside[name] != path], n=1)
    folders = [path.parent, Path("results") / path.name, *(beside[name] for name in close)]
    return next((str(folder) for folder in folders if (folder / SCENARIO).is_file()), None)


def find_newest(scenario: str, beside: Path) -> Path | None:
    """The folder in results, or `beside`, of the run of the scenario of that name which was begun last."""
    folders = {
        folder.resolve(): folder for parent in (Path("results"), beside) for folder in _list_runs(parent)
    }
    own = [folder for folder in folders.values() if _read_name(folder / SCENARIO) == scenario]
    return max(own, key=lambda folder: (folder / SCENARIO).stat().st_mtime, default=None)


def _read_name(scenario: Path) -> object:
    try:
        return parse_toml(read_text(scenario)).get("name")
    except (OSError, ValueError):
        return None


def _list_runs(parent: Path) -> list[Path]:
    try:
        return [folder for folder in sorted(parent.iterdir()) if (folder / SCENARIO).is_file()]
    except OSError:
        return []


def _check_empty(out: Path) -> None:
    if held := _list_written(out):
        raise OutputFolderError(
            f"{format_path(out)}: already holds a result ({held[0].name})", another(), REPLACE
        )


def _list_written(out: Path) -> list[Path]:
    return [*list_files(out), *(path for name in WRITTEN if (path := partial(out / name)).exists())]


def find_run_state(out: Path) -> Path:
    """The folder of the run in `out`; it exists while the run goes on, or after it was killed."""
    return out / UNFINISHED


def format_path(out: Path) -> Path:
    """The folder for messages: relative to the working directory if inside it."""
    here = Path.cwd()
    return out.relative_to(here) if out.is_relative_to(here) else out


@contextmanager
def lock_folder(out: Path) -> Iterator[Path]:
    """The folder, made if it isn't there; MistakeError if another process works on the run.

    Removed at the end if it is empty, as are the folders that it was made in. The lock ends with the process.
    OSError if it cannot be made.
    """
    folder = find_run_state(out)
    made = [path for path in folder.parents if not path.exists()]
    folder.mkdir(parents=True, exist_ok=True)
    lock = locket.lock_file(str(folder / LOCK), timeout=0)
    try:
        lock.acquire()
    except locket.LockError:
        raise MistakeError(f"{format_path(out)}: another process is running it; wait for its end") from None
    try:
        yield folder
    finally:
        lock.release()
        if [path.name for path in folder.iterdir()] == [LOCK]:
            (folder / LOCK).unlink()
            folder.rmdir()
            for path in made:
                if not any(path.iterdir()):
                    path.rmdir()


def clear_run_state(folder: Path) -> None:
    """Remove what is in it but the lock, checkpoints first: journals alone are no run to be resumed."""
    for path in list_run_state(folder):
        path.unlink()


def list_run_state(folder: Path) -> list[Path]:
    """What is in it but the lock, checkpoints first."""
    found = (path for path in folder.iterdir() if path.name != LOCK)
    return sorted(found, key=lambda path: not path.name.startswith(CHECKPOINT))
