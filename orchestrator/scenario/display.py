"""The units in which numbers are shown: one for each quantity, in figures, pages, tables and messages."""

import functools
import math
from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np

from models.core.quantities import Quantity

from .units import USUAL, to_unit

# As they are set in a figure; in a text the degree is a word.
SYMBOLS = {
    "um": "µm",
    "us": "µs",
    "deg": "°",
    "rpm": "r/min",
    "N.m": "N m",
    "N.s": "N s",
    "rad/s2": "rad/s²",
    "m/s2": "m/s²",
    "mm2": "mm²",
}


class Shown(NamedTuple):
    """The factor from the stored unit, and the unit with its symbol ("" of a plain number)."""

    factor: float
    unit: str

    @property
    def symbol(self) -> str:
        return SYMBOLS.get(self.unit, self.unit.replace(".", " "))

    @property
    def text(self) -> str:
        """The symbol in a table or message."""
        return "deg" if self.unit == "deg" else self.symbol


def show(quantity: Quantity) -> Shown:
    """How this quantity is shown."""
    return show_unit(quantity.unit, quantity.display_unit)


def say(value: float, shown: Shown, digits: int = 4) -> str:
    """A number in SI with the unit in which it is shown, e.g. "330 N"."""
    return f"{format_number(shown.factor * value, digits)} {shown.text}".rstrip()


def show_attributes(attributes: Mapping[Any, Any]) -> Shown:
    """How a variable of a result file or store with these attributes is shown."""
    return show_unit(str(attributes.get("units", "1")), str(attributes.get("display_units", "")))


@functools.cache
def show_unit(unit: str, display_unit: str = "") -> Shown:
    """How a number in `unit` (SI symbols) is shown; `display_unit` is what its quantity names."""
    shown = display_unit or USUAL.get(unit, unit)
    factor = 1.0 if shown == unit else 1.0 / to_unit(f"1 {shown}", unit)
    return Shown(factor, "" if shown == "1" else shown)


def add_unit(name: str, shown: Shown) -> str:
    """The head of a column: "load [N]"."""
    return f"{name} [{shown.text}]" if shown.unit else name


def format_number(value: float, digits: int = 4) -> str:
    """With so many significant digits; with an exponent only where it is next to nothing, "–" of nan."""
    if not math.isfinite(value):
        return "–" if math.isnan(value) else str(value)
    rounded = float(f"{value:.{digits}g}")
    tiny = 0.0 < abs(rounded) < 1e-4
    # Zero may be negative.
    return f"{rounded:g}" if tiny else np.format_float_positional(rounded + 0.0, trim="-")


def format_with_error(value: float, error: float) -> str:
    """E.g. -860 +/- 60: two digits of the error at most, rounded up, and rounding moves the value by a tenth
    of it at most. Six digits without an error, or with one below them."""
    if not (math.isfinite(error) and error > 1e-6 * abs(value)):
        return f"{value:.6g}"
    place = -math.floor(math.log10(0.2 * error))
    upper = math.ceil(round(error * 10.0**place, 6)) / 10.0**place
    return " +/- ".join(f"{round(one, place) + 0.0:.{max(0, place)}f}" for one in (value, upper))
