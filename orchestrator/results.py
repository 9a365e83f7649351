"""The result file: netCDF (HDF5) with a group for each of coupled run, reference and macro steps.

Series are appended in blocks and flushed, so that memory stays bounded and what was recorded survives
the end of the process.
"""

from __future__ import annotations

import time as clock
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import h5netcdf
import h5py
import numpy as np

from models.quantities import Quantity, Vector

if TYPE_CHECKING:
    import xarray

BLOCK = 4096  # rows of a block: 32 kB for each variable
FLUSH_SECONDS = 2.0  # what a killed process may lose
TIME = Quantity("s", "time")


class Series:
    """A group of variables over its own `time`, appended row by row."""

    def __init__(self, hdf5: h5py.File, group: h5netcdf.Group, variables: Mapping[str, Quantity]) -> None:
        self._hdf5 = hdf5
        self._group = group
        self._group.dimensions["time"] = None  # unlimited
        columns = {"time": TIME, **variables}
        for name, quantity in columns.items():
            self._make(name, quantity)
        self._paths = [f"{group.name}/{name}" for name in columns]
        self._rows = np.empty((BLOCK, len(columns)))
        self._held = self._written = 0
        self._flushed = clock.monotonic()

    def _make(self, name: str, quantity: Quantity) -> None:
        variable = self._group.create_variable(
            name, ("time",), np.float64, chunks=(BLOCK,), compression="gzip", compression_opts=1, shuffle=True
        )
        variable.attrs["units"] = quantity.unit
        variable.attrs["long_name"] = quantity.description
        if quantity.display_unit:
            variable.attrs["display_units"] = quantity.display_unit
        if quantity.choices:
            variable.attrs["flag_meanings"] = " ".join(quantity.choices)

    def append(self, time: float, values: Vector) -> None:
        """One row; `values` is copied."""
        row = self._rows[self._held]
        row[0] = time
        row[1:] = values
        self._held += 1
        if self._held == BLOCK or clock.monotonic() - self._flushed > FLUSH_SECONDS:
            self.flush()

    def flush(self) -> None:
        """Write what is held, down to the file."""
        if self._held:
            end = self._written + self._held
            # Each by itself: what HDF5 lists as attached to a dimension has been seen to lack one.
            for i, path in enumerate(self._paths):
                dataset = self._hdf5[path]
                dataset.resize(end, axis=0)
                dataset[self._written : end] = self._rows[: self._held, i]
            self._written, self._held = end, 0
        self._hdf5.flush()
        self._flushed = clock.monotonic()


class ResultFile:
    """A result being written. `attributes` say what it is of; `complete` is 0 until `finish`."""

    def __init__(self, path: Path, attributes: Mapping[str, str]) -> None:
        self.path = path
        self._hdf5 = h5py.File(path, "w")  # h5netcdf's own flush stays in memory
        self._file = h5netcdf.File(self._hdf5, "r+")
        self._quantities: dict[str, Mapping[str, Quantity]] = {}
        self._file.attrs["Conventions"] = "CF-1.10"
        for name, text in attributes.items():
            self._file.attrs[name] = text
        self._file.attrs["complete"] = np.int32(0)
        self._file.attrs["message"] = "the run was not finished"

    def series(self, group: str, variables: Mapping[str, Quantity]) -> Series:
        """A new group."""
        self._quantities[group] = variables
        return Series(self._hdf5, self._file.create_group(group), variables)

    def write(self, group: str, times: Vector, variables: Mapping[str, Quantity], values: Vector) -> None:
        """A whole group: `values` has a row for each time."""
        series = self.series(group, variables)
        for time, row in zip(times, values, strict=True):
            series.append(float(time), row)
        series.flush()

    def attribute(self, group: str, name: str, value: Any) -> None:
        """An attribute of a group."""
        self._file[group].attrs[name] = value

    def read(self, group: str, names: Sequence[str], rows: slice) -> dict[str, Vector]:
        """Rows of some variables, as far as they are flushed."""
        return {name: np.asarray(self._file[group][name][rows]) for name in names}

    def has(self, group: str) -> bool:
        """The group exists and has rows."""
        return self.length(group) > 0

    def quantities(self, group: str) -> dict[str, Quantity]:
        """What the group's variables are, as given to `series`."""
        return dict(self._quantities[group])

    def length(self, group: str) -> int:
        """Rows of a group, as far as they are flushed; 0 if there is no such group."""
        if group not in self._file.groups:
            return 0
        return int(self._file[group].dimensions["time"].size)

    def finish(self, complete: bool, message: str) -> None:
        """State how the run ended."""
        self._file.attrs["complete"] = np.int32(complete)
        self._file.attrs["message"] = message or "complete"
        self._hdf5.flush()

    def close(self) -> None:
        self._file.close()
        self._hdf5.close()


def open_result(path: Path | str) -> xarray.DataTree:
    """The result as an xarray DataTree: /coupled, /reference, /steps. `path` is the file or its folder."""
    import xarray

    path = Path(path)
    return xarray.open_datatree(path / "result.nc" if path.is_dir() else path, engine="h5netcdf")
