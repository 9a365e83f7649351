"""Film and pressure of the cam's contact as a finite line: end peaks, profiles, misalignment."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray

from models.contact.analysis.finite_line.dry import dry
from models.contact.analysis.finite_line.solution import Solution
from models.contact.analysis.finite_line.steady import steady, vanishes
from models.contact.hertz import maximum_pressure
from models.core.quantities import Vector
from models.core.system import ModelError

from ..errors import MistakeError
from ..plots.finite_line import draw_finite_line
from ._table import column
from ._tappet import (
    ALIGNMENTS,
    COMPLIANCE,
    CONTACT,
    DRY,
    PARAMETERS,
    PROFILES,
    build_finite_line,
    compute_running,
    describe_yielding,
    read_resolution,
)
from .protocol import Analysis, Parameter, Result

# What is shown: lines along the length, which is a hundred half widths, and nodes across.
LINES, NODES = 401, 201


def _solve(name: str, values: Mapping[str, Any], share: float) -> Solution:
    try:
        at = compute_running(values["angle"], values, share)
        contact = build_finite_line(name, values, at)
        solve = dry if vanishes(contact, at) else steady
        return solve(contact, at, read_resolution(values))
    except ModelError as error:
        raise MistakeError(str(error)) from None


def _collect_results(found: Solution) -> dict[str, float | str]:
    at = found.running
    hertz = maximum_pressure(at.load, at.radius, CONTACT.length, COMPLIANCE)
    return {
        "load": at.load,
        "velocity": at.velocity,
        "radius": at.radius,
        "slope": at.misalignment,
        "hertz_pressure": hertz,
        "largest_pressure": found.largest_pressure,
        "end_pressure": found.end_pressure,
        "middle_pressure": found.middle_pressure,
        "smallest_film": found.smallest_film,
        "end_film": found.end_film,
        "middle_film": found.middle_film,
        "central_film": found.central_film,
        "moment": found.moment,
        "warnings": "; ".join(
            filter(None, (DRY * found.dry, *found.warnings, describe_yielding(found.largest_pressure)))
        ),
    }


def evaluate(values: Mapping[str, Any]) -> dict[str, float | str]:
    return _collect_results(_solve(values["profile"], values, values["alignment"]))


def _interpolate(values: Vector, found: Solution, x: Vector, y: Vector) -> Vector:
    """Values of a solution's nodes at x and y; lines at the ends keep their value up to the end."""
    grid = found.grid
    at_x = np.array([np.interp(x, grid.x, line) for line in values.T]).T
    return np.array([np.interp(y, grid.y, row) for row in at_x])


def build_table(values: Mapping[str, Any]) -> xarray.Dataset:
    """Pressure and film of the chosen profile over x and y, and of all profiles what is largest and
    smallest along y; each aligned and misaligned."""
    y = np.linspace(-0.5, 0.5, LINES) * CONTACT.length
    shares = dict(zip(ALIGNMENTS, (0.0, values["alignment"]), strict=True))
    found = {
        (kind, share): _solve(kind, values, share) for kind in PROFILES for share in set(shares.values())
    }
    peaks, films = (
        [
            [
                np.interp(y, found[kind, share].grid.y, getattr(found[kind, share], name))
                for share in shares.values()
            ]
            for kind in PROFILES
        ]
        for name in ("peak_along", "least_along")
    )
    chosen = [found[values["profile"], share] for share in shares.values()]
    x = np.linspace(max(each.grid.x[0] for each in chosen), min(each.grid.x[-1] for each in chosen), NODES)
    over, every = ("aligned", "x", "y"), ("kind", "aligned", "y")
    pressure = [_interpolate(each.pressure, each, x, y) for each in chosen]
    film = [_interpolate(each.film, each, x, y) for each in chosen]
    return xarray.Dataset(
        {
            "pressure": column(over, pressure, "Pa", "pressure of the chosen profile"),
            "film": column(over, film, "m", "film thickness of the chosen profile"),
            "peak_along": column(every, peaks, "Pa", "largest pressure of every line along x"),
            "least_along": column(every, films, "m", "smallest film of every line along x"),
            **_collect_results(chosen[-1]),
        },
        coords={
            "x": column("x", x, "m", "along the motion of the surfaces"),
            "y": column("y", y, "m", "along the length"),
            "kind": column("kind", list(PROFILES), "1", "axial profile"),
            "aligned": column("aligned", list(ALIGNMENTS), "1", "alignment of the shaft"),
        },
    )


ANALYSIS = Analysis(
    name="finite_line",
    description="The cam's contact as a finite line: end peaks, axial profiles, misalignment",
    parameters={
        "angle": Parameter(math.pi, "rad", "cam angle, nose at pi"),
        **PARAMETERS,
        "nodes_per_half_width": Parameter(16.0, "1", "nodes along x per half width", positive=True),
    },
    results={
        "load": Result("N", "contact load"),
        "velocity": Result("m/s", "entraining velocity"),
        "radius": Result("m", "radius of curvature"),
        "slope": Result("rad", "misalignment"),
        "hertz_pressure": Result("Pa", "largest pressure of the line contact by Hertz"),
        "largest_pressure": Result("Pa", "largest pressure"),
        "end_pressure": Result("Pa", "largest pressure within a tenth of the length from the ends"),
        "middle_pressure": Result("Pa", "largest pressure in the middle of the length"),
        "smallest_film": Result("m", "smallest film"),
        "end_film": Result("m", "smallest film within a tenth of the length from the ends"),
        "middle_film": Result("m", "smallest film in the middle of the length"),
        "central_film": Result("m", "film in the middle of the contact"),
        "moment": Result("N.m", "moment of the pressure about the middle of the length"),
        "warnings": Result("1", "what is not to be trusted", text=True),
    },
    evaluate=evaluate,
    table=build_table,
    draw=draw_finite_line,
)
