"""The zarr store of a study: a coordinate for each parameter, a variable for each result, status, message.

Only the process that runs the study writes it. Files are replaced whole, the results of a point before its
status. Nothing depends on the time or order of points. So a study that is killed at any moment and continued
ends with the same store.
"""

import json
import math
import os
import shutil
import warnings
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import locket
import numpy as np
import zarr
from numpy.typing import NDArray

from ..analyses import Result
from ..errors import REPLACE, MistakeError, RunError, another
from ..store.output_folder import refuse_file, refuse_unwritable
from .files import MESSAGE, STATUS, Plan
from .points import POINT
from .source import describe_difference
from .task import Outcome

PENDING, DONE, FAILED = 0, 1, 2
FLAGS = {"flag_values": [PENDING, DONE, FAILED], "flag_meanings": "pending done failed"}
FORMAT = "tribocosim study 1"
# Points of a chunk, which is written whole: small chunks are fast, large ones need few files.
CHUNK = 4096


class Store:
    """An open store, with all arrays in memory."""

    def __init__(self, path: Path) -> None:
        group = zarr.open_group(path, mode="r+")
        self._path = path
        attributes: dict[str, Any] = dict(group.attrs)
        self._results: list[str] = attributes["results"]
        self._written = [*self._results, MESSAGE, STATUS]  # in this order
        self._arrays: dict[str, Any] = {name: group[name] for name in self._written}
        self._values = {name: np.asarray(array[...]) for name, array in self._arrays.items()}
        self._changed: set[tuple[int, ...]] = set()

    @property
    def status(self) -> NDArray[np.int8]:
        """Of every point, in the order of the study."""
        return self._values[STATUS].ravel()

    def message(self, index: int) -> str:
        return str(self._values[MESSAGE].ravel()[index])

    def pending(self) -> list[int]:
        return [int(index) for index in np.flatnonzero(self.status == PENDING)]

    def count(self, status: int) -> int:
        return int(np.count_nonzero(self.status == status))

    def retry_failed(self) -> None:
        """Make failed points pending again; their messages stay until there is another outcome."""
        for index in np.flatnonzero(self.status == FAILED):
            self._set(int(index), STATUS, PENDING)
        self.flush()

    def record(self, index: int, outcome: Outcome) -> None:
        """Set a point's outcome in memory; `flush` writes it."""
        for name in self._results:
            if name in outcome.values:
                self._set(index, name, outcome.values[name])
        self._set(index, MESSAGE, outcome.message)
        self._set(index, STATUS, FAILED if outcome.message else DONE)

    def _set(self, index: int, name: str, value: Any) -> None:
        values = self._values[name]
        place = np.unravel_index(index, values.shape)
        values[place] = value
        chunks = self._arrays[STATUS].chunks
        self._changed.add(tuple(int(i) // n for i, n in zip(place, chunks, strict=True)))

    def flush(self) -> None:
        """Write the changed chunks, status last; RunError if the disk refuses."""
        try:
            for name in self._written:
                for chunk in sorted(self._changed):
                    self._write(name, chunk)
        except OSError as error:
            raise RunError(
                f"{self._path}: cannot be written ({error.strerror or error}); what is finished is kept, the "
                "same command continues"
            ) from None
        self._changed.clear()

    def _write(self, name: str, chunk: tuple[int, ...]) -> None:
        array = self._arrays[name]
        region = tuple(slice(i * n, (i + 1) * n) for i, n in zip(chunk, array.chunks, strict=True))
        array[region] = self._values[name][region]


@contextmanager
def open_store(path: Path, plan: Plan, versions: Mapping[str, str], overwrite: bool) -> Iterator[Store]:
    """Open or create the store at `path`; MistakeError if another study or process owns it."""
    refuse_file(path.parent)
    with _lock(path):
        try:
            _prepare(path, plan, versions, overwrite)
        except OSError as error:
            raise refuse_unwritable(path, error) from None
        yield Store(path)


def _prepare(path: Path, plan: Plan, versions: Mapping[str, str], overwrite: bool) -> None:
    if overwrite and path.exists():
        _read_attributes(path)
        shutil.rmtree(path)
    if not path.exists():
        _create_store(path, plan, versions)
        return
    _compare(path, plan, versions)
    for left in path.rglob("*.partial"):
        left.unlink()


@contextmanager
def _lock(path: Path) -> Iterator[None]:
    """Keep other processes from writing the store. The lock ends with the process."""
    file = path.with_name(f".{path.name}.lock")
    lock = locket.lock_file(str(file), timeout=0)
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        lock.acquire()
    except OSError as error:
        raise refuse_unwritable(path, error) from None
    except locket.LockError:
        raise MistakeError(f"{path}: another process is working on it", "wait for its end") from None
    try:
        yield
    finally:
        lock.release()
        file.unlink(missing_ok=True)


def _read_attributes(path: Path) -> dict[str, Any]:
    """The attributes of a store; MistakeError if it is not a study's."""
    try:
        found = dict(zarr.open_group(path, mode="r").attrs)
    except (OSError, ValueError, KeyError):
        found = {}
    if found.get("format") != FORMAT:
        raise MistakeError(f"{path}: is not the store of a study", another())
    return found


def _compare(path: Path, plan: Plan, versions: Mapping[str, str]) -> None:
    """MistakeError unless the store has this study, points and versions."""
    found = _read_attributes(path)
    group: Any = zarr.open_group(path, mode="r")
    same_points = set(found["parameters"]) == set(plan.points.coordinates) and all(
        np.array_equal(group[name][...], _to_array(values))
        for name, values in plan.points.coordinates.items()
    )
    if found["subject"] != plan.subject.content() or not same_points:
        what = "other points" if found["subject"] == plan.subject.content() else "another study"
        raise MistakeError(f"{path}: holds {what}", another(), REPLACE)
    if changed := describe_difference(json.loads(found["versions"]), dict(versions)):
        raise MistakeError(f"{path}: was begun by another version ({changed})", another(), REPLACE)


def _create_store(path: Path, plan: Plan, versions: Mapping[str, str]) -> None:
    """Create a store with all points pending; it appears at once, complete."""
    unfinished = path.with_name(f".{path.name}.new")
    shutil.rmtree(unfinished, ignore_errors=True)
    points, results = plan.points, plan.subject.results
    attributes: dict[str, Any] = plan.attributes() | {
        "format": FORMAT,
        "versions": json.dumps(dict(versions)),
        "parameters": list(points.coordinates),
        "results": list(results),
    }
    if POINT in points.dimensions:
        attributes["coordinates"] = " ".join(points.coordinates)
    group = zarr.create_group(unfinished, zarr_format=3, attributes=attributes)
    for name, values in points.coordinates.items():
        array = _to_array(values)
        group.create_array(
            name, shape=array.shape, chunks=array.shape, dtype=str if array.dtype == object else array.dtype,
            dimension_names=[name if name in points.dimensions else POINT],
            attributes=_describe(plan.subject.describe(name)),
        )[...] = array  # fmt: skip

    def create_empty(name: str, kind: Any, empty: Any, about: Mapping[str, Any]) -> None:
        group.create_array(
            name, shape=points.shape, chunks=choose_chunks(points.shape), dtype=kind, fill_value=empty,
            dimension_names=points.dimensions, attributes=dict(about),
        )  # fmt: skip

    for name, result in results.items():
        kind, empty = (str, "") if result.text else (np.float64, math.nan)
        create_empty(name, kind, empty, _describe(result))
    create_empty(MESSAGE, str, "", {"long_name": "why the point failed"})
    create_empty(STATUS, np.int8, PENDING, {"long_name": "state of the point"} | FLAGS)
    with warnings.catch_warnings():
        # Not every reader of format 3 uses consolidated metadata; those that do open the store faster.
        warnings.filterwarnings("ignore", "Consolidated metadata", zarr.errors.ZarrUserWarning)
        zarr.consolidate_metadata(unfinished)
    os.replace(unfinished, path)


def _describe(result: Result) -> dict[str, Any]:
    """The attributes of a variable."""
    about = {"long_name": result.description, "units": result.unit}
    return about | ({"display_units": result.display_unit} if result.display_unit else {})


def choose_chunks(shape: Sequence[int]) -> tuple[int, ...]:
    """Chunks of at most CHUNK points, with whole trailing dimensions."""
    left, sizes = CHUNK, []
    for size in reversed(shape):
        sizes.append(max(1, min(size, left)))
        left //= sizes[-1]
    return tuple(reversed(sizes))


def _to_array(values: Sequence[Any]) -> NDArray[Any]:
    """A parameter's values as booleans, integers, floats or strings."""
    for kind in (bool, int):
        if all(type(value) is kind for value in values):
            return np.array(values)
    if any(isinstance(value, str) for value in values):
        return np.array([str(value) for value in values], dtype=object)
    return np.array(values, dtype=np.float64)
