"""The table of a revolution as netCDF or CSV."""

from pathlib import Path

import numpy as np
import xarray

from models.core.quantities import Vector

from .cycle import SUMMARY, Cycle, Wear, summarise

# What only computes others, and the abscissa.
LEFT_OUT = ("cam_angle", "cam_sliding", "entraining_velocity")
# Ends of the names of the CSV files with wear, by dimension.
WEAR_TABLES = {"cam_place": "cam-wear", "follower_place": "follower-wear"}


def of(cycle: Cycle, worn: Wear, coefficient: float) -> xarray.Dataset:
    """Friction over the records of a revolution, wear over the cam's angle and along the follower."""

    def along(dimension: str, values: Vector, unit: str) -> xarray.Variable:
        return xarray.Variable(dimension, values, {"units": unit})

    found = xarray.Dataset(
        {
            name: along("cam_angle", values, cycle.units.get(name, "1"))
            for name, values in cycle.values.items()
            if name not in LEFT_OUT
        },
        coords={
            "cam_angle": along("cam_angle", cycle["cam_angle"], "rad"),
            "cam_place": along("cam_place", worn.cam_angle, "rad"),
            "follower_place": along("follower_place", worn.follower_place, "m"),
        },
    )
    found["friction_torque"] = along("cam_angle", cycle.torque, "N.m")
    found["friction_power"] = along("cam_angle", cycle.power, "W")
    found["cam_wear"] = along("cam_place", worn.cam_depth, "m")
    found["follower_wear"] = along("follower_place", worn.follower_depth, "m")
    for name, value in summarise(cycle).items():
        about = {"units": SUMMARY[name].unit, "long_name": SUMMARY[name].description}
        found[name] = xarray.Variable((), np.float64(value), about)
    return found.assign_attrs(
        contact=cycle.contact,
        wear_coefficient=coefficient,
        title="Friction and wear over a cam revolution; wear depths of one revolution",
    )


def write(cycle: Cycle, worn: Wear, coefficient: float, path: Path) -> list[Path]:
    """One file as netCDF, as CSV one for each dimension; OSError if one cannot be written."""
    path.parent.mkdir(parents=True, exist_ok=True)
    found = of(cycle, worn, coefficient)
    if path.suffix == ".nc":
        found.to_netcdf(path, engine="h5netcdf")
        return [path]
    files = {"cam_angle": path} | {
        dimension: path.with_stem(f"{path.stem}-{words}") for dimension, words in WEAR_TABLES.items()
    }
    for dimension, file in files.items():
        part = found.drop_vars([name for name in found if found[name].dims != (dimension,)])
        frame = part.drop_dims([name for name in part.dims if name != dimension]).to_dataframe().reset_index()
        frame.columns = [f"{name} [{found[name].attrs['units']}]" for name in frame.columns]
        frame.to_csv(file, index=False)
    return list(files.values())
