"""Axes of maps and bifurcation diagrams as parameters of analyses."""

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from typing import Any

import numpy as np
import xarray

from models.core.quantities import Vector
from models.slider_crank.motions.maps import VARIABLES

from ..errors import MistakeError
from ._machine import MACHINE
from ._table import column
from .protocol import Parameter


def declare_axis(letter: str, name: str, first: float, last: float, count: int) -> dict[str, Parameter]:
    """Parameters of an axis: what varies along it, first and last value, count."""
    return {
        letter: Parameter(name, "1", f"parameter along {letter}", choices=VARIABLES),
        f"{letter}_from": Parameter(first, "1", f"its first value along {letter}"),
        f"{letter}_to": Parameter(last, "1", f"its last value along {letter}"),
        f"{letter}_count": Parameter(count, "1", f"values along {letter}", minimum=1.0, integer=True),
    }


def read_axis(values: Mapping[str, Any], letter: str) -> tuple[str, Vector]:
    """The varied parameter and its equally spaced values."""
    first, last, count = (values[f"{letter}_{part}"] for part in ("from", "to", "count"))
    return values[letter], np.linspace(first, last, count)


def read_coordinate(values: Mapping[str, Any], letter: str) -> xarray.Variable:
    """The values along an axis, with unit and description."""
    name, found = read_axis(values, letter)
    return column(letter, found, MACHINE[name].unit, MACHINE[name].description)


@contextmanager
def report_mistakes() -> Iterator[None]:
    """Report values that a machine refuses as mistakes of the user."""
    try:
        yield
    except ValueError as error:
        raise MistakeError(str(error)) from None
