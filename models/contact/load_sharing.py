"""A contact's load between fluid film and asperities (Johnson, Greenwood and Poon 1972).

The film carries W_f, the asperities W_a = A p_a on the Hertzian area A, and W_f + W_a = W. A film under less
load is thicker, as its formula says: h = h_0 h_ss(W_f)/h_ss(W) with the film h_0 that the whole load would
leave. A thicker film means less load on asperities, more on the film, and by the formula a thinner film:
there is one solution. A formula whose film grows with its load (`kushwaha`) cannot share so: its film is
kept. No film presses the surfaces closer than they come dry, where W_a = W.
"""

import math
from typing import NamedTuple

from ..compile.kernel import kernel
from .asperities import THICK, Asperities, dry_separation, mean_gap, pressure_scale, pressure_under
from .films import film_by_number
from .films.groups import Conditions

# Formulas are not asked for less than this share of the load, nor for a speed of zero (m/s).
_LEAST_SHARE = 1e-12
_LEAST_SPEED = 1e-9
# A share of asperities below this is none.
_NEGLIGIBLE = 1e-24
# Logarithms of W_f/W_a between which all solutions lie.
_LEAST_ODDS, _LARGEST_ODDS = math.log(_LEAST_SHARE), -math.log(_NEGLIGIBLE)
# The error that a last correction of the logarithm leaves is less than its square.
_CLOSE = 1e-8


class Sharing(NamedTuple):
    """Film thickness (m) and load on the asperities (N)."""

    film: float
    asperity_load: float


@kernel
def formula_film(model: float, load: float, at: Conditions) -> float:
    """h_ss(W) in m, for positive load, of the formula with this number in FILMS."""
    speed = max(abs(at.velocity), _LEAST_SPEED)
    moving = Conditions(speed, at.radius, at.length, at.compliance, at.viscosity, at.pressure_viscosity)
    return film_by_number(model, load, moving)


@kernel
def _thickening(share: float, load: float, whole: float, model: float, at: Conditions) -> float:
    """h/h_0, at least 1: the film under a share of the load over h_ss(W), that under the whole load."""
    return max(1.0, formula_film(model, max(share, _LEAST_SHARE) * load, at) / whole)


@kernel
def _solve(
    share: float, load: float, film: float, per_load: float, surfaces: Asperities, scale: float,
    model: float, at: Conditions,
) -> Sharing:  # fmt: skip
    """The sharing in which both carry some; `share` is A p_a/W under the film h_0, and A/W = `per_load`.

    Newton's method, kept between bounds, for the logarithm z of W_f/W_a: ln(A p_a/W_a) grows with z, by
    W_f/W + (d ln p_a/d ln h) (d ln h/d ln W_f) W_a/W. The last factor but one is that between two iterates.
    """
    whole = formula_film(model, load, at)
    low, high = _LEAST_ODDS, _LARGEST_ODDS
    last_fluid = last_thicker = 0.0  # logarithms, of the whole load
    z = math.log(1.0 / min(share, 0.5) - 1.0)
    for _ in range(100):
        odds = math.exp(z)
        fluid = z - math.log(1.0 + odds)
        thicker = _thickening(odds / (1.0 + odds), load, whole, model, at)
        log_thicker = math.log(thicker)
        pressed = pressure_under(film * thicker, surfaces.roughness, scale)
        excess = math.log(max(per_load * pressed.pressure, 1e-300) * (1.0 + odds))
        if excess > 0.0:
            high = z
        else:
            low = z
        exponent = (log_thicker - last_thicker) / (fluid - last_fluid) if fluid != last_fluid else 0.0
        last_fluid, last_thicker = fluid, log_thicker
        steepness = film * thicker * pressed.slope / max(pressed.pressure, 1e-300)
        change = -excess * (1.0 + odds) / (odds + exponent * steepness)
        if not low <= z + change <= high:
            change = 0.5 * (low + high) - z
        z += change
        if abs(change) < _CLOSE:
            break
    odds = math.exp(z)
    return Sharing(film * _thickening(odds / (1.0 + odds), load, whole, model, at), load / (1.0 + odds))


@kernel
def share_load(
    load: float, film: float, area: float, surfaces: Asperities, model: float, at: Conditions
) -> Sharing:
    """Sharing of the load W >= 0 on the area A > 0 (m2), of a film h_0 >= 0 that the whole load would leave.

    Without film the asperities carry all. Between smooth surfaces there are none, whatever the film. The
    pressure of asperities is that of `pressure_under`, to 2e-8.
    """
    if surfaces.roughness <= 0.0 or load <= 0.0 or film >= THICK * surfaces.roughness:
        return Sharing(film, 0.0)
    if film <= 0.0:
        return Sharing(0.0, load)
    scale, per_load = pressure_scale(surfaces, at.compliance), area / load
    share = per_load * pressure_under(film, surfaces.roughness, scale).pressure
    if share <= _NEGLIGIBLE:
        return Sharing(film, 0.0)
    if share >= 1.0:
        thickest = film * _thickening(_LEAST_SHARE, load, formula_film(model, load, at), model, at)
        if per_load * pressure_under(thickest, surfaces.roughness, scale).pressure >= 1.0:
            dry = dry_separation(1.0 / per_load, surfaces, at.compliance)
            return Sharing(surfaces.roughness * mean_gap(dry), load)
    return _solve(share, load, film, per_load, surfaces, scale, model, at)
