"""A run's output folder: what is in it, and when it may be written."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path

from ..errors import MistakeError
from ..scenario import Scenario
from ..scenario.files import to_full_toml
from ..store.atomic_write import partial
from ..store.backup import Earlier
from ..store.run_state import clear, contents, locked, shown, unfinished

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


def spare(source: Path, scenario: Scenario, out: Path) -> None:
    """OutputFolderError if the result's own scenario file would replace `source` by something else."""
    target = out / SCENARIO
    if target.exists() and target.samefile(source) and source.read_text("utf-8") != to_full_toml(scenario):
        raise OutputFolderError(
            f"{target}: is the scenario itself, which a result here would replace; choose another folder "
            "with --out"
        )


@contextmanager
def prepared(out: Path, overwrite: bool) -> Iterator[tuple[Path, Earlier]]:
    """The folder for what is unfinished, in an empty output folder that no other process writes.

    A result or an unfinished run in `out` is put aside if `overwrite`, and refused otherwise. What has not
    been dropped at the end of the block is put back.
    """
    if out.exists() and not out.is_dir():
        raise OutputFolderError(f"{shown(out)}: is a file; choose a folder with --out")
    if not overwrite:
        _check_empty(out)
    with ExitStack() as stack:
        try:
            folder = stack.enter_context(locked(out))
            earlier = Earlier(out)
            earlier.put_back()  # what a process killed before its run began has left there
            earlier.put_aside([*_held(out), *contents(folder)])
        except OSError as error:
            raise OutputFolderError(
                f"{shown(out)}: cannot be written ({error.strerror}); choose another --out"
            ) from None
        try:
            yield folder, earlier
        finally:
            if earlier.held:
                clear(folder)
                for file in _held(out):
                    file.unlink()
                earlier.put_back()


def files(out: Path) -> list[Path]:
    """What a run has written, in the order to be shown."""
    found = [out / name for name in (SUMMARY, RESULT, CSV, UNITS, SCENARIO)]
    return [path for path in [*found, *_figures(out)] if path.exists()]


def meant(path: Path) -> str | None:
    """The run's output folder that was probably meant by `path`, a file in it or the scenario's name."""
    folders = (path.parent, Path("results") / path.name)
    return next((str(folder) for folder in folders if (folder / SCENARIO).is_file()), None)


def _check_empty(out: Path) -> None:
    if unfinished(out).exists() and (out / SCENARIO).exists():
        raise OutputFolderError(
            f"{shown(out)}: holds a run that was not finished; continue it with tribocosim resume "
            f"{shown(out)}, choose another folder with --out, or replace it with --overwrite"
        )
    if held := _held(out):
        raise OutputFolderError(
            f"{shown(out)}: already holds a result ({held[0].name}); choose another folder with --out, "
            "or replace it with --overwrite"
        )


def _held(out: Path) -> list[Path]:
    paths = [out / name for name in (RESULT, CSV, UNITS, SCENARIO, SUMMARY)]
    return [path for path in [*paths, *map(partial, paths), *_figures(out)] if path.exists()]


def _figures(out: Path) -> list[Path]:
    return sorted((out / FIGURES).glob("*.png"))
