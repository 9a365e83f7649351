"""Friction of a film that its own shear heats: the temperature at which it shears, from one balance of heat.

The heat of friction over Hertz's area A, q = (F_v + F_b) |u_s|/A, goes through both surfaces into their
bodies. A body past which the contact moves with U takes it as a half-space does (Carslaw and Jaeger 1959,
10.7): under even heating the mean rise of its surface is q_i/h_i, with

    h_i^2 = (3/4)^2 pi k rho c U/(2 b) + {pi k/(2 b [ln(L/b) + 1/2])}^2

of fast passing, and of a standing contact of length L. Both surfaces have one mean rise (Blok 1937), so
q = (h_1 + h_2) dT_s. Heat q_v = F_v |u_s|/A arises in the film. All layers share one stress, so that the
hottest one shears most. The film shears as an evenly warm one of so much above the surfaces:

    dT_f = q_v h/(12 k_o) phi,  phi = 3 D/(2 N),  D = ln(sinh 2c/(2c)),  N = c tanh c

with the fall D of ln(eta) over dT_f, under the mean pressure (Nahme 1940). This is exact where ln(eta) falls
evenly with the temperature, also for Eyring's fluid. phi is 1, the mean of a parabola (Crook 1961), in a
cold film, and tends to 3, the peak of a film that shears in its middle alone.

Viscosity, and so F_v, fall with the rise: the balance has one solution.
"""

import math
from typing import NamedTuple

from ..compile.kernel import kernel
from .fluid import Lubricant, log_viscosity
from .friction import COSINES, POINTS, WEIGHTS, Traction
from .rheology import Thermal, fluid_stress, limited_stress, pressed_share, stress_slope, thin_by_heat

# Relative accuracy of the rise. Newton's steps converge quadratically: the last is far smaller than this.
_CLOSE = 1e-9
_STEPS = 60
# D of a film that is cold but for 1e-8 of phi.
_SMALL = 1e-4
# K. A rise that changes a viscosity by less than this accuracy.
_COLD = 1e-9


class Contact(NamedTuple):
    """Half width b, length L (m), and the sliding velocity u_s and the entraining velocity u (m/s)."""

    half_width: float
    length: float
    sliding: float
    entraining: float


class Solid(NamedTuple):
    """Conductivity k (W/(m K)) and heat capacity rho c (J/(m3 K))."""

    conductivity: float
    capacity: float


class Cooling(NamedTuple):
    """Conductances of both bodies (W/(m2 K)), and the oil's conductivity (W/(m K))."""

    body_1: float
    body_2: float
    oil_conductivity: float


class HotFilm(NamedTuple):
    """Viscous friction (N), and rises over the oil's temperature (K): the surfaces' mean, and that of an
    evenly warm film that shears alike."""

    viscous: float
    surface_rise: float
    film_rise: float


class _Peak(NamedTuple):
    """phi and its derivative by D."""

    factor: float
    slope: float


class _Shear(NamedTuple):
    """Viscous friction (N), not negative, and its derivative by the rise (N/K)."""

    force: float
    slope: float


@kernel
def conductance(solid: Solid, velocity: float, half_width: float, length: float) -> float:
    """h_i in W/(m2 K), of a body past which the contact moves with a velocity (m/s)."""
    passing = 9.0 * math.pi / 32.0 * solid.conductivity * solid.capacity * abs(velocity) / half_width
    slender = math.log(max(length / half_width, 1.0)) + 0.5
    standing = math.pi * solid.conductivity / (2.0 * half_width * slender)
    return math.sqrt(passing + standing * standing)


@kernel
def build_cooling(contact: Contact, solid_1: Solid, solid_2: Solid, oil_conductivity: float) -> Cooling:
    """The bodies pass the contact with u + u_s/2 and u - u_s/2."""
    b, length = contact.half_width, contact.length
    return Cooling(
        conductance(solid_1, contact.entraining + 0.5 * contact.sliding, b, length),
        conductance(solid_2, contact.entraining - 0.5 * contact.sliding, b, length),
        oil_conductivity,
    )


@kernel
def concentrate(fall: float) -> _Peak:
    """phi of a film whose ln(eta) falls by D >= 0 from its walls to its own temperature (see above)."""
    if fall < _SMALL:
        return _Peak(1.0 + 0.3 * fall, 0.3)
    # Newton's method from above for w = 2c in ln(sinh w/w) = D, which is convex.
    w, slope = fall + math.sqrt(6.0 * fall), 1.0
    for _ in range(_STEPS):
        slope = 1.0 / math.tanh(w) - 1.0 / w
        change = (w + math.log(-0.5 * math.expm1(-2.0 * w) / w) - fall) / slope
        w -= change
        if abs(change) <= _CLOSE * w:
            break
    tangent = math.tanh(0.5 * w)
    heat = 0.5 * w * tangent
    growth = 0.5 * (tangent + 0.5 * w * (1.0 - tangent * tangent)) / slope
    return _Peak(1.5 * fall / heat, 1.5 * (heat - fall * growth) / (heat * heat))


@kernel
def _shear(
    rise: float, pressure: float, film: float, contact: Contact, fluid: Lubricant, thermal: Thermal,
    traction: Traction,
) -> _Shear:  # fmt: skip
    """Under Hertz's pressure with this maximum (Pa) and a film h > 0 (m) of one thickness and temperature."""
    thinned, rate = thin_by_heat(rise, fluid.viscosity, thermal), abs(contact.sliding) / film
    total = slope = 0.0
    for i in range(POINTS):
        p = pressure * COSINES[i]
        share, limit = pressed_share(p, fluid), traction.limiting_stress + traction.limiting_coefficient * p
        log = log_viscosity(p, fluid)[0] + thinned.value * share
        newtonian = fluid.viscosity * math.exp(log) * rate
        stress = fluid_stress(newtonian, fluid.eyring_stress)
        total += WEIGHTS[i] * limited_stress(stress, limit, traction.limiting_law)
        growth = stress_slope(newtonian, fluid.eyring_stress, limit, traction.limiting_law)
        slope += WEIGHTS[i] * growth * thinned.slope * share
    area = 2.0 * contact.half_width * contact.length
    return _Shear(area * total, area * slope)


@kernel
def heat_film(
    pressure: float, film: float, boundary: float, contact: Contact, cooling: Cooling, fluid: Lubricant,
    thermal: Thermal, traction: Traction,
) -> HotFilm:  # fmt: skip
    """The film's balance of heat: largest pressure of the fluid (Pa), film h (m), and boundary friction (N).

    Newton's method for ln(T/(R F_v)), T the share of the rise that the film's shear makes, between bounds.
    """
    per_area = abs(contact.sliding) / (2.0 * contact.half_width * contact.length)
    surfaces = per_area / (cooling.body_1 + cooling.body_2)
    base = abs(boundary) * surfaces
    if film <= 0.0 or contact.sliding == 0.0:
        return HotFilm(0.0, base, base)
    across = per_area * film / (12.0 * cooling.oil_conductivity)
    share, resistance = pressed_share(0.25 * math.pi * pressure, fluid), surfaces
    low, rise, high = 0.0, 0.0, math.inf
    for step in range(_STEPS):
        found = _shear(base + rise, pressure, film, contact, fluid, thermal, traction)
        hot = thin_by_heat(base + rise, fluid.viscosity, thermal)
        warm = thin_by_heat(base + surfaces * found.force, fluid.viscosity, thermal)
        peak = concentrate(share * max(warm.value - hot.value, 0.0))
        resistance = surfaces + across * peak.factor
        made = resistance * found.force
        if step == 0:
            if made <= _COLD:
                rise = made
                break
            # Newton's for T - R F_v, which falls short where F_v is convex, as Newton's fluid's.
            high, rise = 3.0 * made, made / (1.0 - resistance * found.slope)
            continue
        if rise > made:
            high = rise
        else:
            low = rise
        change = 0.5 * (low + high) - rise
        if made > 0.0:
            growth = across * peak.slope * share * (warm.slope * surfaces * found.slope - hot.slope)
            by_newton = -math.log(rise / made) / (
                1.0 / rise - found.slope / found.force - growth / resistance
            )
            if low <= rise + by_newton <= high:
                change = by_newton
        rise += change
        if abs(change) <= _CLOSE * rise:
            break
    viscous = rise / resistance
    surface = base + surfaces * viscous
    return HotFilm(math.copysign(viscous, contact.sliding), surface, base + rise)
