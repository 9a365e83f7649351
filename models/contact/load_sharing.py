"""A contact's load between fluid film and asperities (Johnson, Greenwood and Poon 1972).

The film carries W_f, the asperities W_a = A p_a on the Hertzian area A, and W_f + W_a = W. A film under less
load is thicker, as its formula says: h = h_0 h_ss(W_f)/h_ss(W) with the film h_0 that the whole load would
leave. More separation means less load on asperities, more on the film, and by the formula less separation:
there is one solution. A formula whose film grows with its load (`kushwaha`) cannot share so: its film is
kept. No film presses the surfaces closer than they come dry, where W_a = W.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from ..compile.kernel import kernel
from .asperities import THICK, Asperities, asperity_pressure, dry_separation, find_separation, mean_gap
from .films import film_by_number

# Formulas are not asked for less than this share of the load, nor for a speed of zero (m/s).
_LEAST_SHARE = 1e-12
_LEAST_SPEED = 1e-9


class Sharing(NamedTuple):
    """Film thickness (m), separation of the mean planes over sigma, and load on the asperities (N)."""

    film: float
    separation: float
    asperity_load: float


class FilmFormula(NamedTuple):
    """A formula and what it is asked at, besides the load (see `films`)."""

    model: float
    velocity: float
    radius: float
    length: float
    compliance: float
    viscosity: float
    pressure_viscosity: float


@kernel
def formula_film(load: float, f: FilmFormula) -> float:
    """h_ss(W) in m, for positive load."""
    return film_by_number(
        f.model, load, max(abs(f.velocity), _LEAST_SPEED), f.radius, f.length, f.compliance, f.viscosity,
        f.pressure_viscosity,
    )  # fmt: skip


@kernel
def _excess(separation: float, load: float, area: float, ratio: float, whole: float, surfaces: Asperities,
            f: FilmFormula) -> float:  # fmt: skip
    """Logarithm of the film under the fluid's share over the mean gap: falls with the separation."""
    share = 1.0 - area * asperity_pressure(separation, surfaces, f.compliance) / load
    thicker = max(1.0, formula_film(max(share, _LEAST_SHARE) * load, f) / whole)
    return math.log(ratio * thicker / mean_gap(separation))


@kernel
def share_load(load: float, film: float, area: float, surfaces: Asperities, f: FilmFormula) -> Sharing:
    """Sharing of the load W >= 0 on the area A > 0 (m2), of a film h_0 >= 0 that the whole load would leave.

    Without film the asperities carry all. Between smooth surfaces there are none, whatever the film.
    """
    if surfaces.roughness <= 0.0:
        return Sharing(film, THICK, 0.0)
    ratio = film / surfaces.roughness
    if load <= 0.0 or ratio >= THICK:
        return Sharing(film, ratio, 0.0)
    pressure = load / area
    if film <= 0.0:
        return Sharing(0.0, dry_separation(pressure, surfaces, f.compliance), load)
    whole = formula_film(load, f)
    # The solution is not below these; a film that is kept has it at once.
    low = find_separation(ratio)
    if asperity_pressure(low, surfaces, f.compliance) > pressure:
        low = dry_separation(pressure, surfaces, f.compliance)
    at_low = _excess(low, load, area, ratio, whole, surfaces, f)
    high, at_high, step = low, at_low, 0.25
    for _ in range(60):
        if not at_high > 0.0:
            break
        low, at_low = high, at_high
        high += step
        step *= 2.0
        at_high = _excess(high, load, area, ratio, whole, surfaces, f)
    found = high
    # Regula falsi with Illinois' weights.
    for _ in range(60):
        if high - low < 1e-10 or at_low <= 0.0:
            break
        found = high - at_high * (high - low) / (at_high - at_low)
        at_found = _excess(found, load, area, ratio, whole, surfaces, f)
        if abs(at_found) < 1e-12:
            break
        if at_found < 0.0:
            high, at_high, at_low = found, at_found, 0.5 * at_low
        else:
            low, at_low, at_high = found, at_found, 0.5 * at_high
    carried = min(load, area * asperity_pressure(found, surfaces, f.compliance))
    return Sharing(surfaces.roughness * mean_gap(found), found, carried)
