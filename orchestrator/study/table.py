"""The points of a study as a CSV table: parameters, results, status and message, in the units of figures."""

from pathlib import Path

import numpy as np
import xarray

from ..scenario.display import add_unit, show_attributes
from ..store.csv_file import write_sheet
from .files import MESSAGE, STATUS


def write_table(found: xarray.Dataset, path: Path) -> None:
    """A line for each point of a store, in the order of the study."""
    names = [*found.attrs["parameters"], *found.attrs["results"], STATUS, MESSAGE]
    states = found[STATUS].attrs["flag_meanings"].split()
    frame = found.to_dataframe(dim_order=list(found[STATUS].dims)).reset_index()[names]
    frame[STATUS] = np.array(states)[frame[STATUS].to_numpy()]
    shown = {name: show_attributes(found[name].attrs) for name in names}
    for name in names:
        if shown[name].factor != 1.0:
            # Twelve digits: 3000 r/min are 3000 again.
            frame[name] = [float(f"{shown[name].factor * value:.12g}") for value in frame[name]]
    frame.columns = [add_unit(name, shown[name]) for name in names]
    write_sheet(path, frame.to_csv(index=False, lineterminator="\n"))
