"""A sweep over speed, made up: load and film are known functions of speed and angle."""

import json
import math
from pathlib import Path

import numpy as np
import xarray

SPEEDS = np.array([100.0, 200.0, 300.0])
ROWS = 181


def load_of(speed: np.ndarray, angle: np.ndarray) -> np.ndarray:
    """Of the contact (N)."""
    return np.asarray(speed * (1.5 + np.cos(angle)))


def write_sweep(folder: Path) -> None:
    """The files that `tribocosim speeds` leaves, without a scenario."""
    share = np.linspace(0.0, 1.0, ROWS)
    angle = np.broadcast_to(2.0 * math.pi * share, (len(SPEEDS), ROWS))
    load = load_of(SPEEDS[:, None], angle)
    dims = ("speed", "share")
    cycles = xarray.Dataset(
        {
            "cam_angle": (dims, angle, {"units": "rad"}),
            "contact.load": (dims, load, {"units": "N", "long_name": "contact load"}),
            "contact.film_thickness": (
                dims,
                1e-6 / load,
                {"units": "m", "display_units": "um", "long_name": "film"},
            ),
        },
        {"speed": SPEEDS, "share": share},
        {"cam_ratio": 0.5},
    )
    cycles.to_netcdf(folder / "cycles.nc", engine="h5netcdf")
    numbers = xarray.Dataset(
        {
            "contact.least_load": ("speed", load.min(axis=1), {"units": "N", "long_name": "least load"}),
            "contact.lost": ("speed", [0.0, 0.0, 0.1]),
            "valve.bounce": ("speed", np.full(len(SPEEDS), np.nan), {"units": "m"}),
            "status": ("speed", np.ones(len(SPEEDS), np.int8)),
        },
        {"speed": SPEEDS},
    )
    numbers.to_zarr(folder / "speeds.zarr", zarr_format=2, consolidated=True)
    summary = {"scenario": "made", "separation": {"text": "contact is lost from 2000.0 r/min"}}
    (folder / "summary.json").write_text(json.dumps(summary), "utf-8")
