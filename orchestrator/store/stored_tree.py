"""A result file as an xarray DataTree, read by h5py.

h5netcdf takes over 10 ms to find the dimensions of each variable: minutes for thousands.
"""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import h5py
import xarray
from xarray.backends import BackendArray
from xarray.core import indexing

# Attributes of netCDF and HDF5 themselves, and of what has become coordinates.
OWN = {"CLASS", "NAME", "DIMENSION_LIST", "REFERENCE_LIST", "coordinates", "_NCProperties"}
ONLY_A_DIMENSION = b"This is a netCDF dimension but not"


class _Stored(BackendArray):
    """A variable whose values are read when they are asked for."""

    def __init__(self, stored: Any) -> None:
        self._stored, self.shape, self.dtype = stored, stored.shape, stored.dtype

    def __getitem__(self, key: Any) -> Any:
        support = indexing.IndexingSupport.OUTER_1VECTOR
        return indexing.explicit_indexing_adapter(key, self.shape, support, self._stored.__getitem__)


def read_tree(path: Path) -> xarray.DataTree:
    """The tree of a file that `ResultFile` has written; it is closed with the tree."""
    file = h5py.File(path, "r")
    tree = xarray.DataTree.from_dict(dict(_list_datasets(file)))
    tree.set_close(file.close)
    return tree


def _list_datasets(group: Any) -> Iterator[tuple[str, xarray.Dataset]]:
    """The group at its path, and those in it."""
    variables = {}
    for name, stored in group.items():
        if isinstance(stored, h5py.Group):
            yield from _list_datasets(stored)
        elif not bytes(stored.attrs.get("NAME", b"")).startswith(ONLY_A_DIMENSION):
            dimensions = ("time", "node")[: stored.ndim]
            values = indexing.LazilyIndexedArray(_Stored(stored))
            variables[name] = xarray.Variable(dimensions, values, _read_attributes(stored))
    names = str(group.attrs.get("coordinates", "")).split()
    yield group.name, xarray.Dataset(variables, attrs=_read_attributes(group)).set_coords(names)


def _read_attributes(of: Any) -> dict[str, Any]:
    own = {key: of.attrs[key] for key in of.attrs if key not in OWN and not key.startswith("_Netcdf4")}
    return {key: value[0] if getattr(value, "shape", ()) == (1,) else value for key, value in own.items()}
