"""Friction of a mixed-lubricated line contact: shear of the film, and boundary friction of asperities.

The film, sheared at u_s/h, resists by its viscosity eta(p), as Eyring's fluid if it has an Eyring stress
tau_0 (Johnson and Tevaarwerk 1977), and at most by a limiting stress:

    tau = eta u_s/h   or   tau = tau_0 asinh(eta u_s/(tau_0 h)),   |tau| <= tau_L0 + gamma p

The asperities add mu_b W_a + tau_b A_c (real area A_c). Isothermal; only sliding resists here, `rolling`
has the pressure flow's part.
"""

import math
from typing import Any, NamedTuple

import numpy as np

from ..compile.kernel import kernel, uncounted
from .asperities import (
    THICK,
    Asperities,
    dry_separation,
    find_separation,
    pressure_scale,
    pressure_under,
    real_area_share,
)
from .fluid import Lubricant, viscosity_at
from .load_sharing import Sharing
from .rheology import fluid_stress, limited_stress

# Gauss-Legendre points for the angle in x = b sin(angle), where a Hertzian contact's integrand is smooth.
POINTS = 12
_LEGENDRE, WEIGHTS = np.polynomial.legendre.leggauss(POINTS)
COSINES = np.cos(0.25 * math.pi * (_LEGENDRE + 1.0))
WEIGHTS = 0.25 * math.pi * WEIGHTS * COSINES


class Traction(NamedTuple):
    """Limiting stress tau_L0 + gamma p (Pa) and boundary friction mu_b W_a + tau_b A_c (tau_b in Pa).

    `limiting_law` is a position in LIMITING_LAWS.
    """

    limiting_stress: float = 2e6
    limiting_coefficient: float = 0.07
    boundary_coefficient: float = 0.1
    boundary_stress: float = 0.0
    limiting_law: float = 0.0


class Friction(NamedTuple):
    """Forces on surface 2 along its sliding past by surface 1 (N): signs as the sliding velocity."""

    viscous: float
    boundary: float


@kernel
def shear_stress(
    pressure: float, velocity: float, film: float, fluid: Lubricant, traction: Traction
) -> float:
    """tau in Pa, with the sign of the sliding velocity u_s (m/s); 0 without film."""
    if film <= 0.0 or velocity == 0.0:
        return 0.0
    limit = traction.limiting_stress + traction.limiting_coefficient * pressure
    stress = fluid_stress(viscosity_at(pressure, fluid) * abs(velocity) / film, fluid.eyring_stress)
    return math.copysign(limited_stress(stress, limit, traction.limiting_law), velocity)


@kernel
def viscous_friction(
    half_width: float, length: float, maximum_pressure: float, velocity: float, film: float,
    fluid: Lubricant, traction: Traction,
) -> float:  # fmt: skip
    """Integral of tau over a Hertzian pressure and a film of one thickness (N)."""
    total = 0.0
    for i in range(POINTS):
        total += WEIGHTS[i] * shear_stress(maximum_pressure * COSINES[i], velocity, film, fluid, traction)
    return 2.0 * half_width * length * total


@kernel
def boundary_friction(asperity_load: float, real_area: float, velocity: float, traction: Traction) -> float:
    """mu_b W_a + tau_b A_c against the sliding (N); 0 at rest."""
    if velocity == 0.0:
        return 0.0
    size = traction.boundary_coefficient * asperity_load + traction.boundary_stress * real_area
    return math.copysign(size, velocity)


@kernel
def hertzian_friction(
    load: float, half_width: float, length: float, velocity: float, carried: Sharing, fluid: Lubricant,
    surfaces: Asperities, compliance: float, traction: Traction,
) -> Friction:  # fmt: skip
    """Friction of a Hertzian contact under the load W >= 0 (N); the film has its share of the pressure."""
    if load <= 0.0:
        return Friction(0.0, 0.0)
    area = 2.0 * half_width * length
    pressure = 4.0 / math.pi * (load - carried.asperity_load) / area
    real_area = 0.0
    if traction.boundary_stress > 0.0:  # else it has no part in the friction
        separation = dry_separation(carried.asperity_load / area, surfaces, compliance)
        real_area = area * real_area_share(separation, surfaces.roughness_parameter)
    return Friction(
        viscous_friction(half_width, length, pressure, velocity, carried.film, fluid, traction),
        boundary_friction(carried.asperity_load, real_area, velocity, traction),
    )


class ProfileFriction(NamedTuple):
    """Of given profiles: load of the asperities (N), their real area (m2), and friction as `Friction`."""

    asperity_load: float
    real_area: float
    viscous: float
    boundary: float


@uncounted
def find_sheared_share(x: Any, pressure: Any, i: int, step: int) -> float:
    """How much of the way from node i, where the fluid has pressure, to the next (step = 1 or -1) is its.

    Half of it, or, where the next has no pressure, as far as it falls to zero with the distance squared.
    Sheared lengths are then continuous while nodes get or lose their pressure.
    """
    last = len(x) - 1
    if not 0 <= i + step <= last:
        return 0.0
    way = abs(x[i + step] - x[i])
    if pressure[i + step] > 0.0:
        return 0.5 * way
    if not 0 <= i - step <= last or pressure[i - step] <= pressure[i]:
        return way
    ratio = math.sqrt(pressure[i] / pressure[i - step])
    return min(way, abs(x[i] - x[i - step]) * ratio / (1.0 - ratio))


@kernel
def profile_friction(
    x: Any, pressure: Any, film: Any, stress: Any, length: float, velocity: float, compliance: float,
    surfaces: Asperities, traction: Traction,
) -> ProfileFriction:  # fmt: skip
    """Asperity load and friction of profiles p(x) of the fluid (Pa), h(x) (m) and its shear stress (Pa), by
    the trapezoidal rule.

    Where the fluid has no pressure it has cavitated, or not yet filled the gap, and doesn't shear.
    """
    load = area = viscous = 0.0
    scale = pressure_scale(surfaces, compliance)
    for i in range(len(x)):
        width = 0.5 * (x[min(i + 1, len(x) - 1)] - x[max(i - 1, 0)]) * length
        if film[i] < THICK * surfaces.roughness:
            separation = find_separation(film[i] / surfaces.roughness)
            load += width * pressure_under(film[i], surfaces.roughness, scale).pressure
            area += width * real_area_share(separation, surfaces.roughness_parameter)
        if pressure[i] > 0.0:
            sheared = (
                find_sheared_share(x, pressure, i, -1) + find_sheared_share(x, pressure, i, 1)
            ) * length
            viscous += sheared * stress[i]
    return ProfileFriction(load, area, viscous, boundary_friction(load, area, velocity, traction))
