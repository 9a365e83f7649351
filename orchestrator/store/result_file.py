"""The result file: netCDF (HDF5) with a group for each of coupled run, reference and macro steps.

It is made of the run's journals when the coupled run has ended, in blocks, so that memory stays bounded;
it appears under its name only when it is whole.
"""

from __future__ import annotations

import math
import os
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from types import TracebackType
from typing import TYPE_CHECKING, Any

import h5netcdf
import h5py
import numpy as np

from models.core.quantities import Quantity, Vector

from ..errors import Command
from .atomic_write import check_room, naming, partial
from .coordinates import Coordinate, Extension
from .journal import TIME, Recorded
from .output_folder import RESULT, OutputFolderError, find_run_state, refuse_missing

if TYPE_CHECKING:
    import xarray

DESCRIBED = 8192  # bytes at most for a variable's names, attributes and places; some 3 kB were measured
PROFILES = "fields"  # the group of profiles across solved contacts
PACKED = {"compression": "gzip", "compression_opts": 1, "shuffle": True}
LISTED = 65_000  # bytes: HDF5's attributes have 64 KiB
CHUNK = 4096  # rows of a compressed chunk: and of what is written at once: 32 kB of a variable


class ResultFile:
    """A result being written, in a `with` block. `attributes` say what it is of; groups with the sources of
    `coordinates` have these too.

    The file appears at the end of the block, if `finish` was called in it; until then it has the name
    `partial(path)`.
    """

    def __init__(
        self, path: Path, attributes: Mapping[str, str], coordinates: Mapping[str, Coordinate] | None = None
    ) -> None:
        self.path = path
        self._coordinates = coordinates or {}
        try:
            with naming(path):
                # Chunks are written whole and read once; HDF5 would hold 1 MB of them for each variable.
                self._hdf5 = h5py.File(partial(path), "w", rdcc_nbytes=CHUNK * 8)
        except OSError:
            partial(path).unlink(missing_ok=True)
            raise
        self._file = h5netcdf.File(self._hdf5, "r+")
        self._quantities: dict[str, Mapping[str, Quantity]] = {}
        self._file.attrs["Conventions"] = "CF-1.10"
        for name, text in attributes.items():
            self._file.attrs[name] = text
        self._finished = False

    def take(self, group: str, recorded: Recorded) -> None:
        """A new group of a journal's rows."""
        self._write(group, recorded.columns, recorded.rows, recorded.blocks(CHUNK))

    def write(self, group: str, times: Vector, variables: Mapping[str, Quantity], values: Vector) -> None:
        """A new group: `values` has a row for each time."""
        blocks = (
            np.column_stack([times[first : first + CHUNK], values[first : first + CHUNK]])
            for first in range(0, len(times), CHUNK)
        )
        self._write(group, {"time": TIME, **variables}, len(times), blocks)

    def _write(self, name: str, columns: Mapping[str, Quantity], rows: int, blocks: Iterable[Vector]) -> None:
        chunk = min(rows, CHUNK) or CHUNK
        self._quantities[name] = {key: value for key, value in columns.items() if key != "time"}
        extension = Extension(columns, self._coordinates)
        columns = extension.columns
        # As if nothing could be compressed.
        check_room(self.path, len(columns) * (8 * chunk * math.ceil(rows / chunk) + DESCRIBED))
        group = self._file.create_group(name)
        # Of an unlimited dimension h5netcdf asks all variables for their length whenever it makes or opens
        # one; netCDF knows no other of length 0.
        group.dimensions["time"] = rows or None
        place = self._hdf5[group.name]
        time = _make_time(group, columns["time"], chunk)
        datasets = [
            time if key == "time" else _make(place, _to_stored_name(key), quantity, rows, chunk, time)
            for key, quantity in columns.items()
        ]
        _list_attached(time, [dataset for dataset in datasets if dataset is not time])
        if extension.added:
            place.attrs["coordinates"] = " ".join(extension.added)
        first = 0
        for block in extension.extend(blocks):
            for dataset, values in zip(datasets, np.ascontiguousarray(block.T), strict=True):
                dataset[first : first + len(block)] = values
            first += len(block)

    def write_profiles(self, name: str, times: Vector, variables: Mapping[str, tuple[str, Vector]]) -> None:
        """A new group PROFILES/name: unit and values (times x nodes) of each variable, and the times."""
        group = self._file.create_group(f"{PROFILES}/{name}")
        group.dimensions = {"time": len(times), "node": next(iter(variables.values()))[1].shape[1]}
        stored = {"time": (TIME.unit, times), **variables}
        check_room(self.path, sum(values.nbytes + DESCRIBED for _, values in stored.values()))
        for key, (unit, values) in stored.items():
            dimensions = ("time", "node")[: values.ndim]
            variable = group.create_variable(key, dimensions, data=values, compression="gzip", shuffle=True)
            variable.attrs["units"] = unit

    def attribute(self, group: str, name: str, value: Any) -> None:
        """An attribute of a group, or of one of its variables."""
        self._hdf5[group].attrs[name] = value

    def column(self, name: str) -> Vector:
        """All rows of a variable of the coupled run, or of its "time"."""
        return self.read("coupled", [name], slice(None))[name]

    def read(self, group: str, names: Sequence[str], rows: slice) -> dict[str, Vector]:
        """Rows of some variables."""
        return {name: np.asarray(self._hdf5[f"{group}/{_to_stored_name(name)}"][rows]) for name in names}

    def has(self, group: str) -> bool:
        """The group exists and has rows."""
        return self.length(group) > 0

    def quantities(self, group: str) -> dict[str, Quantity]:
        """What the group's variables are, without `time`."""
        return dict(self._quantities[group])

    def length(self, group: str) -> int:
        """Rows of a group; 0 if there is no such group."""
        if group not in self._file.groups:
            return 0
        return int(self._file[group].dimensions["time"].size)

    def finish(self, complete: bool, message: str) -> None:
        """State how the run ended."""
        self._file.attrs["complete"] = np.int32(complete)
        self._file.attrs["message"] = message or "complete"
        self._finished = True

    def __enter__(self) -> ResultFile:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        try:
            with naming(self.path):
                self._file.close()
                self._hdf5.close()
            if self._finished:
                os.replace(partial(self.path), self.path)
        finally:
            partial(self.path).unlink(missing_ok=True)


def _to_stored_name(name: str) -> str:
    """A variable's name in the file, where / begins a group: third-party FMUs may have it."""
    return name.replace("/", "\N{DIVISION SLASH}")


def _make_time(group: h5netcdf.Group, quantity: Quantity, chunk: int) -> Any:
    """The group's coordinate, which is HDF5's scale of its dimension."""
    variable = group.create_variable("time", ("time",), np.float64, chunks=(chunk,), **PACKED)
    _describe(variable._h5ds, quantity)
    return variable._h5ds


def _make(group: Any, name: str, quantity: Quantity, rows: int, chunk: int, time: Any) -> Any:
    """A variable over `time`.

    For each new one h5netcdf would write the scale's list of all variables anew, in a time that grows with
    their number, and fail where the list is longer than LISTED.
    """
    dataset = group.create_dataset(
        name, (rows,), np.float64, chunks=(chunk,), maxshape=time.maxshape, **PACKED
    )
    scales = np.empty(1, dtype=object)
    scales[0] = np.array([time.ref], dtype=h5py.ref_dtype)
    dataset.attrs.create("DIMENSION_LIST", scales, dtype=h5py.vlen_dtype(h5py.ref_dtype))
    _describe(dataset, quantity)
    return dataset


def _list_attached(time: Any, datasets: Sequence[Any]) -> None:
    """The scale's own list of what is attached to it, which readers of netCDF do without."""
    kind = np.dtype([("dataset", h5py.ref_dtype), ("dimension", np.int32)])
    if 0 < len(datasets) * kind.itemsize < LISTED:
        time.attrs.create("REFERENCE_LIST", np.array([(one.ref, 0) for one in datasets], dtype=kind))


def _describe(dataset: Any, quantity: Quantity) -> None:
    dataset.attrs["units"] = quantity.unit
    dataset.attrs["long_name"] = quantity.description
    if quantity.display_unit:
        dataset.attrs["display_units"] = quantity.display_unit
    if quantity.choices:
        dataset.attrs["flag_meanings"] = " ".join(quantity.choices)
        dataset.attrs["flag_values"] = np.arange(float(len(quantity.choices)))


def find_result(path: Path | str) -> Path:
    """The file of a result, given it or its folder; OutputFolderError if there is none."""
    path = Path(path)
    file = path if path.suffix == ".nc" else path / RESULT
    if file.exists():
        return file
    if find_run_state(file.parent).exists():
        resume = Command("resume", (file.parent,))
        raise OutputFolderError(f"{file}: the run goes on or was killed", ("continue it with ", resume))
    refuse_missing(file.parent)
    raise OutputFolderError(f"{file.parent}: has no {file.name}", "give the output folder of a run")


def open_result(path: Path | str) -> xarray.DataTree:
    """The result as an xarray DataTree: /coupled, /reference, /steps. `path` is the file or its folder."""
    from .stored_tree import read_tree  # xarray takes long to import

    return read_tree(find_result(path))
