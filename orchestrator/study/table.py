"""The points of a study as a CSV table: parameters, results, status and message, with units in the head."""

from pathlib import Path

import numpy as np
import xarray

from ..store.atomic_write import replace
from .files import MESSAGE, STATUS


def write_table(found: xarray.Dataset, path: Path) -> None:
    """A line for each point of a store, in the order of the study."""
    names = [*found.attrs["parameters"], *found.attrs["results"], STATUS, MESSAGE]
    states = found[STATUS].attrs["flag_meanings"].split()
    frame = found.to_dataframe(dim_order=list(found[STATUS].dims)).reset_index()[names]
    frame[STATUS] = np.array(states)[frame[STATUS].to_numpy()]
    units = {name: found[name].attrs.get("units", "") for name in names}
    frame.columns = [name if units[name] in ("", "1") else f"{name} [{units[name]}]" for name in names]
    replace(path, frame.to_csv(index=False, lineterminator="\n").encode())
