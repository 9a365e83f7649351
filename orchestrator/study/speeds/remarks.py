"""What a sweep over speed says of its cycles: which numbers are doubtful, and what the lift loses."""

from collections.abc import Iterator

import numpy as np
import xarray
from numpy.typing import NDArray

from models.contact.films import GROWING
from models.core.system import System
from models.core.words import tally
from models.monolithic.cycle import STEADY

from ...assessment.adjusters import describe_over_speed
from ...assessment.contacts.lines import FED
from ...assessment.lost_contact import find_lost, find_unsteady
from ...assessment.springs import MORE_TRAVEL, list_clashing
from ...assessment.trains import describe_floating
from .separation import RPM, list_speeds
from .subject import SpeedSubject


def list_doubts(subject: SpeedSubject, system: System, table: xarray.Dataset) -> list[str]:
    """Sentences on what makes the numbers of cycles doubtful."""
    unsteady = list(describe_unsteady(table))
    floating = describe_floating(system) if unsteady else []
    return [
        *unsteady, *floating, *describe_clash(system, table), *describe_yielding(table),
        *describe_feeding(subject, table), *describe_over_speed(table),
    ]  # fmt: skip


def _list_where(table: xarray.Dataset, holds: NDArray[np.bool_]) -> str:
    """The speeds at which this holds."""
    return list_speeds(table["speed"].values[holds], table["speed"].values)


def describe_unsteady(table: xarray.Dataset) -> Iterator[str]:
    """A sentence on the speeds at which no cycle was found: their worst, and what its numbers are."""
    unsteady = table.sel(speed=find_unsteady(table))
    if not unsteady.sizes["speed"]:
        return
    worst = unsteady.isel(speed=int(np.argmax(unsteady["change"].values)))
    yield (
        f"no steady cycle at {list_speeds(unsteady['speed'].values, table['speed'].values)}; the worst at "
        f"{float(worst['speed']) * RPM:.0f} r/min, where a period still changes the motion by "
        f"{100.0 * float(worst['change']):.2g} % after {tally(int(worst['periods']), 'period')} "
        f"(steady: {100.0 * STEADY:g} %). Such a motion may be subharmonic or chaotic; its numbers are "
        "of the period that changes it least"
    )


def describe_clash(system: System, table: xarray.Dataset) -> Iterator[str]:
    """A sentence on each spring whose coils, all of one gap, touch at some speed."""
    found = {str(name): column.values for name, column in table.data_vars.items()}
    for spring, gaps in list_clashing(system, found):
        worst = int(np.nanargmin(gaps))
        yield (
            f"coils of {spring} clash at {_list_where(table, gaps < 0.0)}, "
            f"the tightest {-1e3 * gaps[worst]:.3g} mm of travel beyond coil bind at "
            f"{float(table['speed'][worst]) * RPM:.0f} r/min; {MORE_TRAVEL}"
        )


def describe_yielding(table: xarray.Dataset) -> Iterator[str]:
    """A sentence on each contact whose bodies yield at some speed."""
    for name in (str(name) for name in table.data_vars if str(name).endswith(".stress_ratio")):
        ratio, contact = table[name].values, name.rpartition(".")[0]
        if not (yields := ratio > 1.0).any():
            continue
        worst = int(np.nanargmax(ratio))
        pressure = 1e-6 * float(table[f"{contact}.peak_pressure"][worst])
        yield (
            f"the pressure in {contact} is above the elastic limit at "
            f"{_list_where(table, yields)}, {pressure:.4g} MPa at "
            f"{float(table['speed'][worst]) * RPM:.0f} r/min: the bodies yield, which is not computed"
        )


def describe_feeding(subject: SpeedSubject, table: xarray.Dataset) -> Iterator[str]:
    """A sentence on each contact whose film formula grows with the load and feeds its vibrations."""
    for name in map(str, table.data_vars):
        contact, _, number = name.rpartition(".")
        if number != "film_feed" or not (fed := table[name].values > FED).any():
            continue
        if subject.scenario.components[contact].parameters.get("film_model", GROWING) != GROWING:
            continue
        power = float(np.max(table[f"{contact}.film_power"].values[fed]))
        yield (
            f"{contact}: at {_list_where(table, fed)} its film formula gives up to "
            f"{power:.3g} W to the motion, which no shaft supplies: it feeds vibrations, so that loads, "
            "bounces and separations come out too large; compare with "
            f"components.{contact}.parameters.film_model = 'dowson_toyoda'"
        )


def describe_lift_loss(table: xarray.Dataset) -> Iterator[str]:
    """A sentence on each valve: what its lift loses of the area that it has at the lowest speed.

    Speeds at which contact is lost are left out: a valve that flies has more area.
    """
    followed = table.isel(speed=np.flatnonzero(~find_lost(table)))
    for name in (str(name) for name in table.data_vars if str(name).endswith(".lift_area")):
        area, speeds = followed[name].values, followed["speed"].values * RPM
        if not area.size:
            continue
        loss = 1.0 - area / area[0]
        worst = int(np.argmax(np.abs(loss)))
        if worst:
            change = f"{100.0 * abs(loss[worst]):.3g} % {'less' if loss[worst] > 0.0 else 'more'}"
            change = f"{change} at {speeds[worst]:.0f} than at {speeds[0]:.0f} r/min"
            if abs(loss[worst]) < 1e-4:  # tables have four digits
                change = f"unchanged from {speeds[0]:.0f} to {speeds[-1]:.0f} r/min"
            yield f"{name.rpartition('.')[0]}: the area under its lift is {change}"
