"""Where contacts were pressed beyond what their bodies bear elastically."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from models.monolithic.difference import time_weights
from models.system import System

from .validity import Read, contacts


@dataclass(frozen=True)
class Overload:
    """The largest pressure of a contact (Pa), when (s), its limit (Pa), and share of the time above it."""

    pressure: float
    time: float
    limit: float
    share: float


Overloads = dict[str, Overload]


def overloads(system: System, read: Read) -> Overloads:
    """The contacts whose recorded pressure passed their `elastic_limit`; others are not listed."""
    found = {}
    for name, parameters in contacts(system).items():
        limit = parameters["elastic_limit"]
        # One contact at a time: there may be millions of records.
        time, pressure = read(["time", f"{name}.maximum_pressure"]).values()
        beyond = pressure > limit
        if beyond.any():
            highest = int(np.nanargmax(pressure))
            share = float(np.average(beyond, weights=time_weights(time)))
            found[name] = Overload(float(pressure[highest]), float(time[highest]), limit, share)
    return found


def lines(found: Overloads) -> list[str]:
    """A sentence for each contact."""
    return [
        f"{name}: the pressure reaches {one.pressure / 1e9:.3g} GPa at t = {one.time:.6g} s, above the "
        f"elastic limit of {one.limit / 1e9:.3g} GPa ({100.0 * one.share:.2g} % of the time): the bodies "
        f"yield, which is not computed; lower the load, or set components.{name}.parameters.elastic_limit "
        "to the material's"
        for name, one in found.items()
    ]
