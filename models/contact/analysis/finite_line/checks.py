"""When a solution is not to be trusted: too coarse a grid, too short an inlet, an outlet without an end."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from ...hertz import half_width
from ..inlet import inlet_width
from .inlet import share_before

if TYPE_CHECKING:
    from .contact import FiniteLine, Running
    from .solution import Solution

# Fewer nodes than this to a half width give a wrong film without any other sign.
FEWEST_NODES = 12
# Fewer in the inlet, in which the film forms, give films that are wrong by more than 3 %, measured at M = 30
# and 100, L = 1 to 10; eight by 0.4 %.
FEWEST_IN_INLET = 2.0
# So much of the inlet's pressure may come from before the grid: it costs the film 0.2 %.
LARGEST_INLET_SHARE = 0.2
# Pressure of the last column, relative to the largest, that counts as none.
_NONE = 1e-9


def inlet_share(contact: FiniteLine, running: Running, half_width: float, film: float, first: float) -> float:
    """The pressure of the inlet before x = -first (m), over 1/alpha.

    The film forms where the pressure reaches 1/alpha (or the Hertz pressure, where that is smaller). Left out
    wholly, this share costs 0.6 times itself of the film, measured; with `before_grid` 0.01 times.
    """
    unit = half_width / (2.0 * running.radius * contact.compliance)
    wedge = (
        12.0 * contact.fluid.viscosity * abs(running.velocity) * running.radius**2 / (half_width**3 * unit)
    )
    film_unit = half_width**2 / running.radius
    pressure = unit * wedge * share_before(1.0, film / film_unit, first / half_width)
    return pressure * max(contact.fluid.pressure_viscosity, 1.0 / unit)


def nodes_in_inlet(found: Solution) -> float:
    """How many nodes stand in the inlet: the mean over the load, as errors add up (inversely squared)."""
    per_length = found.load_per_length
    radius, x = found.running.radius, found.grid.x
    middle = np.argmin(np.abs(x))
    side = -1.0 if found.running.velocity > 0.0 else 1.0
    total = 0.0
    for film, load, width in zip(found.film[middle], per_length, found.grid.widths, strict=True):
        if load > 0.0:
            b = half_width(load, radius, 1.0, found.contact.compliance)
            step = float(np.interp(side * b, 0.5 * (x[1:] + x[:-1]), np.diff(x)))
            total += load * width * (step / inlet_width(b, film, radius)) ** 2
    return math.sqrt(found.load / total)


def find_warnings(found: Solution) -> tuple[str, ...]:
    """Each with value, bound and remedy."""
    found_warnings = []
    nodes = 0.5 * np.count_nonzero(np.abs(found.grid.x) < found.half_width)
    if nodes < FEWEST_NODES - 1.0:
        found_warnings.append(
            f"{nodes:.1f} nodes per half width: fewer than {FEWEST_NODES} give a wrong film; raise "
            "nodes_per_half_width"
        )
    in_inlet = nodes_in_inlet(found)
    if in_inlet < FEWEST_IN_INLET:
        found_warnings.append(
            f"{in_inlet:.2g} nodes in the inlet of the film: fewer than {FEWEST_IN_INLET:g} give a wrong "
            "film, first where the contact is wider or narrower than elsewhere; raise nodes_per_half_width, "
            "or in a contact that is evenly wide nodes_per_inlet"
        )
    inlet, outlet = (0, -1) if found.running.velocity > 0.0 else (-1, 0)
    share = inlet_share(
        found.contact, found.running, found.half_width, found.central_film, abs(found.grid.x[inlet])
    )
    if share > LARGEST_INLET_SHARE:
        found_warnings.append(
            f"the inlet begins too near: {100.0 * share:.1f} % of the pressure that forms the film arises "
            f"before the grid, must be <= {100.0 * LARGEST_INLET_SHARE:g} %"
        )
    beside = 1 if outlet == 0 else -2
    if np.max(found.pressure[beside]) > _NONE * found.largest_pressure:
        found_warnings.append("the film does not end before the outlet of the grid: it is too short")
    return tuple(found_warnings)
