"""What the analyses of a mechanism share: its parameters, axes, progress and tables."""

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import fields
from typing import Any

import numpy as np
import xarray

from models.core.quantities import Vector
from models.slider_crank.equations import THESIS_ALPHA, THESIS_BETA, THESIS_XI
from models.slider_crank.motions.machine import FORMS, Machine, Motion
from models.slider_crank.motions.maps import VARIABLES

from ..errors import MistakeError
from ..reporter import show_share
from .protocol import Parameter

MACHINE = {
    "damping": Parameter(0.05, "1", "friction of the crank pin c2 / (M l^2 Omega), F's lambda", minimum=0.0),
    "gap": Parameter(0.01, "1", "clearance over rod length, F's rho", positive=True),
    "restitution": Parameter(0.9, "1", "coefficient of restitution", minimum=0.0, maximum=1.0),
    "form": Parameter("corrected", "1", "equations of motion", choices=FORMS),
    "xi": Parameter(THESIS_XI, "1", "crank radius over rod length", minimum=0.0, maximum=1.0),
    "alpha": Parameter(THESIS_ALPHA, "1", "rod mass over piston mass", minimum=0.0),
    "beta": Parameter(THESIS_BETA, "1", "rod inertia over piston mass and rod length squared", minimum=0.0),
    "sliding_threshold": Parameter(
        0.0, "1", "rebound below which it slides (F: 0.005); 0: chatter to its limit", minimum=0.0
    ),
}

# Parameters of the constraint forces.
MECHANISM = {key: MACHINE[key] for key in MACHINE if key not in ("restitution", "sliding_threshold")}

START = {
    "psi": Parameter(0.0, "rad", "deviation of the rod at the start, crank angle 0"),
    "psi_rate": Parameter(0.0, "1", "its derivative by crank angle"),
}


def declare_duration(cycles: int, transient: int) -> dict[str, Parameter]:
    """Parameters of the duration of a motion, with these defaults."""
    return {
        "cycles": Parameter(cycles, "1", "crank cycles", minimum=1.0, integer=True),
        "transient": Parameter(transient, "1", "crank cycles left out before", minimum=0.0, integer=True),
    }


def build_machine(values: Mapping[str, Any]) -> Machine:
    """The machine, with defaults for parameters that an analysis lacks; MistakeError if none is possible."""
    with report_mistakes():
        return Machine(**{f.name: values[f.name] for f in fields(Machine) if f.name in values})


def simulate_motion(values: Mapping[str, Any]) -> Motion:
    """The motion after its transient; MistakeError for a start outside the walls."""
    with report_mistakes():
        return Motion(build_machine(values), values["psi"], values["psi_rate"]).skip(values["transient"])


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
    return column(letter, found, MACHINE[name].quantity.unit, MACHINE[name].quantity.description)


@contextmanager
def report_mistakes() -> Iterator[None]:
    """Report values that a machine refuses as mistakes of the user."""
    try:
        yield
    except ValueError as error:
        raise MistakeError(str(error)) from None


def show_points(done: int, total: int) -> None:
    """Show how many points are done, in the stage of the analysis."""
    show_share(done / total)


def column(dimensions: str | tuple[str, ...], values: Any, unit: str, meaning: str) -> xarray.Variable:
    """A variable of a table."""
    return xarray.Variable(dimensions, values, {"units": unit, "long_name": meaning})
