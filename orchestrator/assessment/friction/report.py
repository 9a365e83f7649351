"""Friction and wear of contacts as a table to read, what to beware of, and as netCDF or CSV."""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np
import xarray
from rich.table import Table

from models.contact.records import ATOM
from models.core.quantities import Vector

from ...errors import Option, Words
from ...reporter import make_table
from ...scenario.display import format_number, show
from ...store.csv_file import write_sheet
from .cycle import SUMMARY, TURN, Cycle, Wear, summarise

# Numbers of contacts that slide elsewhere than under a cam, with the heads of their columns.
OTHERS = {
    "mean_power": "friction\n(W)",
    "coefficient": "coefficient\nof friction",
    "asperity_share": "asperities'\nload (%)",
    "least_film_ratio": "least film\nratio",
    "volume": "worn off after all\nrevolutions (mm³)",
}
# Of the cam's lift: a profile that has lost more is no longer the one that was computed.
WORN = 0.01
# Contacts side by side in one table.
COLUMNS = 4


@dataclass(frozen=True)
class Judged:
    """A contact's last revolution; wear at the coefficient (m2/N), extrapolated over `cycles` revolutions."""

    cycle: Cycle
    worn: Wear
    coefficient: float
    cycles: float
    roughness: float

    @cached_property
    def summary(self) -> dict[str, float]:
        return summarise(self.cycle)

    @property
    def deepest(self) -> tuple[float, float]:
        """Depth worn off cam and follower in one revolution (m)."""
        return float(self.worn.cam_depth.max()), float(self.worn.follower_depth.max())


def _film(found: Judged) -> str:
    """The film whose ratio is the least: printed numbers are quotients of one another."""
    if found.roughness <= 0.0:
        return "smooth"
    film = found.summary["least_film_ratio"] * found.roughness
    return format_number(1e6 * film) if film >= ATOM else "no film"


def _list_rows(found: Judged) -> Iterator[tuple[str, str, str]]:
    """Words, unit and number."""
    for name, quantity in SUMMARY.items():
        if name == "least_film_ratio":
            yield "least film of the oil under load", "µm", _film(found)
            yield "roughness", "µm", format_number(1e6 * found.roughness, 3)
        shown = show(quantity)
        words, digits = quantity.description.partition(":")[0], 3 if shown.factor != 1.0 else 4
        yield words, shown.symbol, format_number(shown.factor * found.summary[name], digits)
    for body, depth, place in zip(("cam", "follower"), found.deepest, _list_places(found), strict=True):
        yield f"deepest wear of the {body}", "pm", format_number(1e12 * depth, 3)
        yield place
        yield f"{body} after all revolutions", "µm", format_number(1e6 * found.cycles * depth, 3)
    yield "worn off each body", "µm³", format_number(1e18 * found.worn.volume, 3)


def _list_places(found: Judged) -> Iterator[tuple[str, str, str]]:
    worn = found.worn
    yield "  at the cam angle", "deg", f"{math.degrees(worn.cam_angle[worn.cam_depth.argmax()]):.0f}"
    yield "  at the place", "mm", f"{1e3 * worn.follower_place[worn.follower_depth.argmax()]:.2f}"


def tables(found: Sequence[Judged]) -> Iterator[Table]:
    """Of some contacts each."""
    for first in range(0, len(found), COLUMNS):
        some = found[first : first + COLUMNS]
        apart = 1e6 * float(np.diff(some[0].cycle.time).max())
        note = f"wear at {some[0].coefficient:g} m2/N; all revolutions: {some[0].cycles:g}; "
        note += f"from recorded rows, {apart:.3g} µs apart at most"
        title, contacts = "Friction and wear over the last revolution", [each.cycle.contact for each in some]
        table = make_table(title, ["quantity", "unit"], contacts, note)
        for rows in zip(*map(_list_rows, some), strict=True):
            table.add_row(*rows[0], *(number for _, _, number in rows[1:]))
        yield table


def tabulate_others(found: Mapping[str, Mapping[str, float]], cycles: float) -> Table:
    """Contacts that slide elsewhere than under a cam; the volume worn off in so many revolutions."""
    note = "without depths of wear: the paths of these contacts on their bodies are not known"
    table = make_table(
        "Contacts that slide elsewhere than under a cam", ["contact"], list(OTHERS.values()), note
    )
    factors = dict.fromkeys(OTHERS, 1.0) | {"asperity_share": 100.0, "volume": 1e9 * cycles}
    for name, numbers in found.items():
        scaled = (factors[key] * number for key, number in numbers.items())
        table.add_row(name, *("" if math.isnan(one) else format_number(one, 3) for one in scaled))
    return table


def remarks(found: Judged) -> Iterator[Words]:
    """What the numbers of a contact don't say by themselves."""
    cycle, contact = found.cycle, found.cycle.contact
    missing = TURN - cycle.turned
    if missing > 1e-6 * TURN:
        yield (
            f"{contact}: the run covers {math.degrees(cycle.turned):.4g} deg of the revolution; the other "
            f"{math.degrees(missing):.2g} deg count in no number here"
        )
    if (lost := found.summary["lost"]) > 0.0:
        yield (
            f"{contact}: contact is lost in {100.0 * lost:.3g} % of the time. "
            "Means are over all of it; the wear is that of sliding, without that of landing. These are rows "
            f"up to {1e6 * float(np.diff(cycle.time).max()):.3g} µs apart: summary.json has the peaks of all "
            "macro steps"
        )
    lift = float(np.ptp(cycle["cam_lift"]))
    worst = found.cycles * max(found.deepest)
    if worst > WORN * lift:
        yield (
            f"{contact}: {1e6 * worst:.4g} µm of wear are {100.0 * worst / lift:.3g} % of the lift of "
            f"{1e3 * lift:.3g} mm: the computed profile is gone long before {found.cycles:g} revolutions; "
            "extrapolate over at most ",
            Option("cycles", f"{WORN * lift / max(found.deepest):.1g}"),
        )


# What only computes others, and the abscissa.
LEFT_OUT = ("cam_angle", "cam_sliding", "entraining_velocity")
# Ends of the names of the CSV files with wear, by dimension.
WEAR_TABLES = {"cam_place": "cam-wear", "follower_place": "follower-wear"}


def tabulate(cycle: Cycle, worn: Wear, coefficient: float) -> xarray.Dataset:
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
    found = tabulate(cycle, worn, coefficient)
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
        write_sheet(file, frame.to_csv(index=False))
    return list(files.values())
