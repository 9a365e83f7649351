"""The steady line contact under a given load: any speed, load and viscosity, to an accuracy that is measured.

The film is found on a series of grids, each with twice the nodes of the one before. The changes from grid to
grid say how large the error is; a result whose error is larger than asked for is never returned in silence.
Grids grow sharper about the edges of heavily loaded contacts, whose films form in a narrow inlet, and wider
where films are thick against the flattening, since they draw their oil from far away.
"""

import math
import warnings
from collections.abc import Sequence
from dataclasses import dataclass, replace
from numbers import Integral

import numpy as np

from ....core.errors import ModelError
from ....core.quantities import Vector
from ...asperities import pressure_scale
from ...films.moes_venner import moes_film
from ...line.grid import REACH
from ...line.mixed import Bodies, fill_total
from ...line.newton import integrate_pressure
from ...line.reynolds import Flow
from ...line.transient import central, least, wanted_scale
from .fixed_grid import Fields, Mesh, cold_start, interpolate_film, steady_on_grid, workspace
from .line_contact import LineContact, check

# The largest Moes' groups up to which films were found wherever they were tried.
TRIED_M, TRIED_L = 1000.0, 20.0


def likely_cause(contact: LineContact, film: float, nodes: int | None) -> str:
    """Why no film was found on `nodes` (None: any number), and what to do; `film` (m): the one expected."""
    if contact.M > TRIED_M or contact.L > TRIED_L:
        return f"the contact is outside the range of this solver, M <= {TRIED_M:g} and L <= {TRIED_L:g}"
    if contact.squeeze != 0.0:
        # The rate at which the entrained film crosses the contact; oil follows no gap that opens faster.
        carried = abs(contact.velocity) * film / contact.half_width
        return (
            f"squeeze = {contact.squeeze:g} m/s: must be well below velocity * film / half width = "
            f"{carried:.3g} m/s, or oil cannot follow the gap; reduce it, 0 is a steady film"
        )
    return "leave `nodes` out" if nodes else "change the load, the velocity or the asperities"


# Nodes of the series; with the most, a matrix takes 46 megabytes.
COARSEST, FINEST = 151, 2401
FEWEST_NODES, MOST_NODES, FEWEST_COMPARED = 51, 2 * FINEST - 1, 25
# Relative error of the films that is allowed if nothing is said, and the share of it for the missing inlet.
TOLERANCE = 2e-3
STARVED_SHARE = 0.25
MOST_REACH = 320.0
# Inlets that are narrower than this, in half widths, get a sharper grid; it resolves half their width.
NARROW_INLET = 0.25
# Roache's factor (1998) of an error that is estimated from three grids or more.
SAFETY = 1.25
# Moes' load beyond which there are no films to any useful accuracy, as where entrainment all but ends.
MOST_LOAD = 1e5
# The second peak rises by more than this share of the largest pressure above the valley before it.
PEAK_SHARE = 1e-3


class LineContactError(ModelError):
    """No film to the accuracy asked for."""


class LineContactWarning(UserWarning):
    """A film outside the validity of its model, or less accurate than asked for."""


@dataclass(frozen=True)
class Peak:
    """A local maximum of the pressure (Pa) at x (m)."""

    x: float
    pressure: float


@dataclass(frozen=True)
class SteadyFilm:
    """The film on the finest grid of the series, SI units; x points in the direction of positive velocity.

    `pressure` of the oil and `asperity_pressure` (none between smooth surfaces) carry the load together, of
    which `asperity_load` (N) is the asperities'.

    `mesh_error`: of central and minimum film, relative, by the changes along the series (of one grid: inf).
    `starvation`: the share of the load that oil from beyond the grid would carry, at most.
    """

    contact: LineContact
    x: Vector
    pressure: Vector
    asperity_pressure: Vector
    film: Vector
    approach: float
    central_film: float
    minimum_film: float
    asperity_load: float
    mesh_error: float
    starvation: float
    warnings: tuple[str, ...] = ()

    @property
    def nodes(self) -> int:
        return self.x.size

    @property
    def total_pressure(self) -> Vector:
        """Of oil and asperities, which bear on the bodies (Pa)."""
        return np.asarray(self.pressure + self.asperity_pressure)

    @property
    def maximum_pressure(self) -> float:
        """Pa."""
        return float(np.max(self.total_pressure))

    @property
    def second_peak(self) -> Peak | None:
        """The pressure spike before the outlet; None where there is none."""
        ahead = 1 if self.contact.velocity > 0.0 else -1
        p, x = self.total_pressure[::ahead], self.x[::ahead]
        # From the outlet upstream: the first maximum, and whether pressure falls before it rises further.
        highest = float(np.max(p))
        last = int(np.flatnonzero(p > 0.0)[-1])
        while last > 0 and p[last - 1] >= p[last]:
            last -= 1
        valley = last
        while valley > 0 and p[valley - 1] <= p[valley]:
            valley -= 1
        if p[last] - p[valley] <= PEAK_SHARE * highest or np.max(p[: valley + 1]) <= p[valley]:
            return None
        return Peak(float(x[last]), float(p[last]))

    @property
    def H_central(self) -> float:
        """Central film in Moes' unit, R U_S^1/2."""
        return self.central_film / self.contact.film_scale

    @property
    def H_minimum(self) -> float:
        """Minimum film in Moes' unit."""
        return self.minimum_film / self.contact.film_scale


def solve_steady(contact: LineContact, tolerance: float = TOLERANCE, nodes: int | None = None) -> SteadyFilm:
    """The film under the contact's load, central and minimum film right to `tolerance` (relative).

    LineContactError where no grid up to FINEST nodes gives that. With `nodes` (odd) the finest grid is given;
    where it is too coarse, a LineContactWarning says so, as for a pressure above the contact's elastic limit;
    they are in the result's `warnings` too.
    """
    _check(tolerance, nodes)
    if contact.M > MOST_LOAD:
        raise LineContactError(
            f"M = {contact.M:.4g}: must be at most {MOST_LOAD:g} for a steady film; where entrainment "
            "all but ends use the transient line contact"
        )
    reach, starvation = _reach(contact, tolerance)
    sharpness = _sharpness(contact)
    found: list[Fields] = []
    error = math.inf
    for n in _series(nodes):
        fields = _on(Mesh(n, reach, sharpness), contact, found)
        if fields is None:
            found.clear()
            continue
        found.append(fields)
        error = _mesh_error(found)
        if nodes is None and len(found) > 2 and error + starvation <= tolerance:
            break
    if not found:
        raise LineContactError(
            f"M = {contact.M:.4g}, L = {contact.L:.4g}: no film found on {_series(nodes)[-1]} nodes; "
            + likely_cause(contact, _expected(contact), nodes)
        )
    film = _film(contact, found[-1], error, starvation)
    faults = _faults(film, tolerance)
    if nodes is None and faults:
        raise LineContactError(f"M = {contact.M:.4g}, L = {contact.L:.4g}: {'; '.join(faults)}")
    return _add_warnings(film, faults)


def _check(tolerance: float, nodes: int | None) -> None:
    check("tolerance", tolerance, None)
    if not 0.0 < tolerance < 1.0:
        raise ValueError(f"tolerance = {tolerance:g}: must be > 0 and < 1; it is the films' relative error")
    whole = nodes is None or isinstance(nodes, Integral)
    if not whole or (nodes is not None and not (FEWEST_NODES <= nodes <= MOST_NODES and nodes % 2 == 1)):
        raise ValueError(
            f"nodes = {nodes!r}: must be odd, a whole number and from {FEWEST_NODES} to {MOST_NODES}; leave "
            "it out to have as many as the tolerance needs"
        )


def _series(nodes: int | None) -> Sequence[int]:
    """Nodes of the grids, each about twice the one before."""
    if nodes is None:
        series = [COARSEST]
        while series[-1] < FINEST:
            series.append(2 * series[-1] - 1)
        return series
    series = [nodes]
    while len(series) < 3 and series[0] // 4 * 2 + 1 >= FEWEST_COMPARED:
        series.insert(0, series[0] // 4 * 2 + 1)
    return series


def _reach(contact: LineContact, tolerance: float) -> tuple[float, float]:
    """How far the grid reaches, in its scale, and the share of the load that is missing with it at most.

    Beyond |x| = X the gap is about x^2/(2R); oil from there would raise the pressure at -X by
    16 eta0 u R^2/X^3, and with it the load by 24 eta0 u R^2/X^2.
    """
    scale = _scale(contact)
    missing = 24.0 * contact.lubricant.viscosity * abs(contact.velocity) * (contact.radius / scale) ** 2
    missing /= contact.load / contact.length
    reach = REACH
    while missing / reach**2 > STARVED_SHARE * tolerance and reach < MOST_REACH:
        reach *= 2.0
    return reach, missing / reach**2


def _bodies(contact: LineContact) -> Bodies:
    rough = contact.asperities
    if rough is None:
        return Bodies(contact.compliance, contact.length)
    scale = pressure_scale(rough, contact.compliance)
    return Bodies(contact.compliance, contact.length, rough.roughness, scale, rough.roughness_parameter)


def _scale(contact: LineContact) -> float:
    bodies = _bodies(contact)
    return wanted_scale(contact.load / contact.length, _expected(contact), contact.radius, bodies)


def _expected(contact: LineContact) -> float:
    return contact.film_scale * moes_film(contact.M, contact.L)


def _sharpness(contact: LineContact) -> float:
    """Sharpness of the grid, a power of two, so that contacts share grids."""
    b = contact.half_width
    width = _inlet_width(b, _expected(contact), contact.radius) / b  # of the zone in which the film forms
    return 2.0 ** round(math.log2(2.0 / width)) if width < NARROW_INLET else 0.0


def _inlet_width(half_width: float, film: float, radius: float) -> float:
    """b (2 R h/b^2)^(2/3) (m): at a distance s from the edge the gap of the dry contact is some
    (b^2/2R) (s/b)^(3/2), and in the inlet, where the film forms, it is of the size of the film."""
    return half_width * (2.0 * radius * film / half_width**2) ** (2.0 / 3.0)


def _on(mesh: Mesh, contact: LineContact, found: Sequence[Fields]) -> Fields | None:
    """The film on that grid, from the one before or from none."""
    bodies = _bodies(contact)
    flow = Flow(contact.velocity, contact.sliding, contact.radius)

    def settle(start: Fields, at_once: bool) -> Fields | None:
        fluid = contact.lubricant
        return steady_on_grid(start, flow, contact.load, bodies, fluid, contact.squeeze, at_once)

    if found and (fields := settle(interpolate_film(found[-1], mesh), True)) is not None:
        return fields
    cold = cold_start(contact.load, _expected(contact), contact.radius, bodies, _scale(contact), mesh)
    return settle(cold, False)


def _mesh_error(found: Sequence[Fields]) -> float:
    """Relative error of the last grid's films: what all further grids would change if the changes go on to
    shrink as they did (to a half at most, to a quarter at least: order one to two), times SAFETY."""
    if len(found) < 2:
        return math.inf
    worst = 0.0
    for film in (central, least):
        values = [film(fields.h) for fields in found[-3:]]
        change = abs(values[-1] - values[-2])
        shrunk = 2.0
        if len(values) > 2 and change > 0.0:
            shrunk = min(max(abs(values[-2] - values[-3]) / change, 2.0), 4.0)
        worst = max(worst, SAFETY * change / (shrunk - 1.0) / values[-1])
    return worst


def _film(contact: LineContact, last: Fields, error: float, starvation: float) -> SteadyFilm:
    total = np.empty(last.p.size)
    fill_total(last.p, last.h, _bodies(contact), total)
    weight = workspace(last.mesh).weight
    return SteadyFilm(
        contact=contact,
        x=last.X * last.scale,
        pressure=last.p,
        asperity_pressure=total - last.p,
        film=last.h,
        approach=last.approach,
        central_film=float(central(last.h)),
        minimum_film=float(least(last.h)),
        asperity_load=float(integrate_pressure(total - last.p, weight, last.scale)) * contact.length,
        mesh_error=error,
        starvation=starvation,
    )


def _faults(film: SteadyFilm, tolerance: float) -> list[str]:
    """Why the film is less accurate than asked for."""
    faults = []
    if film.mesh_error > tolerance:
        size = f"{film.mesh_error:.2g}" if math.isfinite(film.mesh_error) else "not known"
        on_half_width = float(np.count_nonzero(np.abs(film.x) < film.contact.half_width)) / 2.0
        faults.append(
            f"{film.nodes} nodes ({on_half_width:.0f} on the half width) are too coarse: the "
            f"film's error is {size}, more than {tolerance:g}; take more nodes, or allow a larger tolerance"
        )
    if film.starvation > tolerance:
        faults.append(
            f"the inlet is too short: oil from beyond it would carry {film.starvation:.2g} of the load, more "
            f"than {tolerance:g}; allow a larger tolerance, or use Martin's film of rigid bodies, H = 2.45/M"
        )
    return faults


def _add_warnings(film: SteadyFilm, faults: list[str]) -> SteadyFilm:
    """The film with its warnings, which are given."""
    elastic_limit = film.contact.elastic_limit
    if film.maximum_pressure > elastic_limit:
        faults = [
            *faults,
            f"the pressure reaches {film.maximum_pressure:.3g} Pa, above the elastic limit of "
            f"{elastic_limit:.3g} Pa: bodies of that material yield; lower the load, or set elastic_limit to "
            "the material's",
        ]
    for fault in faults:
        warnings.warn(fault, LineContactWarning, stacklevel=3)
    return replace(film, warnings=tuple(faults))
