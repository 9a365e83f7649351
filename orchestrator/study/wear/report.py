"""What is said of a cam that wears: an answer in words, a table over its ages, its worn lift, a figure."""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from importlib import metadata
from pathlib import Path

import numpy as np
import xarray

from models.core.quantities import Vector
from models.monolithic.cycle import STEADY
from models.valve_train.worn_cam import FINEST, PLACES

from ...assessment.figures_of_merit import CONTACT
from ...assessment.friction.remarks import list_soft, remark_soft
from ...errors import Option, Words
from ...scenario.files import to_full_toml
from ...scenario.lift_table import format_lifts
from ...store.csv_file import write_sheet
from .history import MOST, History, deepest
from .train import CAM, FIGURES, LOSS

PAGE, TABLE, AGES, LIFTS, FIGURE = "wear.html", "wear.nc", "wear.csv", "worn-cam.csv", "wear.png"


@dataclass(frozen=True)
class Interval:
    """Of the wear coefficient (m2/N)."""

    low: float
    high: float

    def cycles(self, dose: float) -> tuple[float, float]:
        """Fewest and most cycles for a dose k N."""
        return dose / self.high, dose / self.low if self.low > 0.0 else math.inf

    def __str__(self) -> str:
        return f"{self.low:.3g} m2/N" if self.low == self.high else f"{self.low:.3g} to {self.high:.3g} m2/N"


def to_text(number: float) -> str:
    """Two digits, with a power of ten where there are many."""
    digits, _, power = f"{number:.1e}".partition("e")
    return f"{number:.2g}" if number < 100.0 or not math.isfinite(number) else f"{digits}e{int(power)}"


def describe_place(angle: float) -> str:
    """Where on the cam (rad; the nose is at pi)."""
    degrees = math.degrees(angle)
    if abs(degrees - 180.0) < 3.0:
        return "at the nose"
    side = "before" if degrees < 180.0 else "after"
    return f"{abs(degrees - 180.0):.0f} deg {side} the nose"


def describe(history: History, interval: Interval) -> str:
    """The answer in one sentence."""
    train, last = history.train, history.ages[-1]
    if not last.dose:
        return f"{train.contact}: {history.fault}"
    low, high = interval.cycles(last.dose)
    hours, distance = train.turn / 3600.0, 1e-3 * last.rubbed.distance
    place = describe_place(float(PLACES[last.state[CAM].argmax()]))
    if last.deepest > last.state[CAM].max():
        along = 0.5 * (train.along[1:] + train.along[:-1])[last.follower.argmax()]
        place = f"of the follower at {1e3 * float(along):.2g} mm"

    def between(factor: float) -> str:
        return to_text(factor * low) + ("" if low == high else f" to {to_text(factor * high)}")

    return (
        f"{1e3 * last.deepest:.4g} mm {place} after {between(1.0)} cycles: {between(hours)} h at "
        f"{60.0 / train.turn:.0f} r/min of the cam, {between(distance)} km of sliding"
    )


def remark(history: History, interval: Interval, tolerance: float) -> Iterator[Words]:
    """Where the answer comes from, and what it leaves out."""
    train, last, fresh = history.train, history.ages[-1], history.ages[0]
    if history.fault and last.dose:
        yield f"this is not the limit of {1e3 * train.limit:g} mm: {history.fault}"
    if not last.dose:
        return
    yield (
        f"from {history.simulated} simulated cycles, with an error of "
        f"{100.0 * history.error / last.deepest:.2g} % by extrapolation, for wear coefficients of {interval}"
    )
    if history.error > tolerance * last.deepest:
        yield (
            f"the error exceeds the tolerance of {100.0 * tolerance:g} %: steps have a least length, so that "
            f"{MOST} cycles usually do"
        )
    constant = last.deepest / deepest(fresh.rubbed.rate) / last.dose
    yield f"the wear of the unworn cam, if it stayed the same, would take {constant:.3g} times as many cycles"
    finest = train.rub(train.unworn, FINEST).rate[CAM].max() / fresh.rubbed.rate[CAM].max()
    yield (
        f"wear is smoothed over the cam angle by a Gaussian of {math.degrees(train.filter):.1f} deg, which "
        f"keeps the cam convex; by one of {math.degrees(FINEST):g} deg the deepest place wears {finest:.3g} "
        "times as fast at first"
    )
    if train.load == "load":
        yield "the surfaces are smooth: all of the load wears, not only that of asperities"
    if roughness := train.parameter("roughness"):
        ratio = fresh.rubbed.numbers["least_film"] / roughness
        yield from remark_soft(list_soft(train.system, {train.contact: ratio}))
    if train.follower_wears:
        yield f"the cam has lost {1e3 * float(last.state[CAM].max()):.3g} mm then"
    else:
        yield (
            f"a follower that does not turn has lost {1e3 * float(last.follower.max()):.3g} mm, which comes "
            "back into the motion only with ",
            Option("wear_follower", True),
        )
    if train.others:
        yield f"without wear in {', '.join(train.others)}: `friction` of a run has the volume worn off there"
    if any(age.rubbed.numbers["lost"] > 0.0 for age in history.ages):
        yield "contact is lost; the wear is that of sliding, without that of landing"
    if (change := max(age.rubbed.numbers["change"] for age in history.ages)) > STEADY:
        yield f"not all cycles are steady: one changes the motion by {100.0 * change:.2g} %"


def tabulate(history: History, interval: Interval) -> xarray.Dataset:
    """All ages, in SI units; `cycles` are those by the largest and by the least wear coefficient."""
    train, ages = history.train, history.ages

    def over(values: list[float], unit: str, words: str) -> xarray.Variable:
        return xarray.Variable("age", values, {"units": unit, "long_name": words})

    def along(place: str, values: list[Vector], words: str) -> xarray.Variable:
        return xarray.Variable(("age", place), np.array(values), {"units": "m", "long_name": words})

    cycles = np.array([interval.cycles(age.dose) for age in ages])
    places_worn = [float(PLACES[age.state[CAM].argmax()]) for age in ages]
    nose = [float(age.state[LOSS][PLACES.size // 2]) for age in ages]
    found = {
        "dose": over([age.dose for age in ages], "m2/N", "wear coefficient times cycles"),
        "fewest_cycles": over(list(cycles[:, 0]), "1", "cycles by the largest wear coefficient"),
        "most_cycles": over(list(cycles[:, 1]), "1", "cycles by the least wear coefficient"),
        "deepest": over([age.deepest for age in ages], "m", "deepest wear of the cam"),
        "place": over(places_worn, "rad", "cam angle of the deepest wear"),
        "lift_loss": over(nose, "m", "lift lost at the nose"),
        "follower_deepest": over(
            [float(a.follower.max()) for a in ages], "m", "deepest wear of the follower"
        ),
        "volume": over([age.volume for age in ages], "m3", "volume worn off each body"),
        **{
            name: over([age.rubbed.numbers[name] for age in ages], quantity.unit, quantity.description)
            for name, (quantity, _) in ((name, CONTACT[name]) for name in FIGURES)
        },
        "depth": along("angle", [age.state[CAM] for age in ages], "depth of the cam"),
        "loss": along("angle", [age.state[LOSS] for age in ages], "lift lost"),
        "follower_depth": along("along", [age.follower for age in ages], "depth of the follower"),
    }
    middle = 0.5 * (train.along[1:] + train.along[:-1])
    places = {
        "angle": xarray.Variable("angle", PLACES, {"units": "rad", "long_name": "cam angle"}),
        "along": xarray.Variable("along", middle, {"units": "m", "long_name": "along the follower"}),
    }
    return xarray.Dataset(found, places).assign_attrs(
        title=f"{train.scenario.name}: {train.worn}",
        answer=describe(history, interval),
        fault=history.fault,
        error=history.error,
        simulated_cycles=history.simulated,
        filter=train.filter,
        wear_coefficient=(interval.low, interval.high),
        version=metadata.version("tribocosim"),
        scenario_toml=to_full_toml(train.scenario),
    )


def write(history: History, table: xarray.Dataset, folder: Path) -> list[Path]:
    """The table, its ages as CSV, and the worn lift as a lift table."""
    files = [folder / name for name in (TABLE, AGES, LIFTS)]
    table.to_netcdf(files[0], engine="h5netcdf")
    ages = table.drop_dims(("angle", "along")).to_dataframe()
    ages.columns = [f"{name} [{table[name].attrs['units']}]" for name in ages.columns]
    write_sheet(files[1], ages.to_csv(index_label="age"))
    points = history.train.fresh.wear_off(history.ages[-1].state[LOSS])
    files[2].write_text(format_lifts(points), "utf-8")
    return files
