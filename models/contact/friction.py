"""Estimate of the friction in a mixed-lubricated line contact.

An estimate: isothermal Newtonian shear of a film of uniform thickness under the mean Hertz pressure,
limited by a share of that pressure, and boundary friction where the film is of the order of the
roughness. The share of the load that the film carries is the fit of Zhu and Hu (2001) as Castro and
Seabra (2007) use it, f = 1.21 L^0.64 / (1 + 0.37 L^1.26), L = h / roughness, 1 from L = 2 on.
"""

from __future__ import annotations

import math

from ..kernel import kernel


@kernel
def fluid_share(film_ratio: float) -> float:
    """Share of the load that the film carries, from 0 (dry) to 1 (film ratio 2 and more)."""
    if film_ratio >= 2.0:
        return 1.0
    if film_ratio <= 0.0:
        return 0.0
    return min(1.0, 1.21 * film_ratio**0.64 / (1.0 + 0.37 * film_ratio**1.26))


@kernel
def viscous_shear_stress(
    viscosity: float, pressure_viscosity: float, mean_pressure: float, sliding_velocity: float,
    film_thickness: float, limiting_coefficient: float,
) -> float:  # fmt: skip
    """min(eta exp(alpha p) |u_s| / h, limit p): Barus viscosity, limiting shear stress (Pa)."""
    limit = limiting_coefficient * mean_pressure
    if film_thickness <= 0.0:
        return limit
    # The exponent is capped where the limit has long taken over, so that exp cannot overflow.
    viscous = viscosity * math.exp(min(pressure_viscosity * mean_pressure, 200.0))
    return min(viscous * abs(sliding_velocity) / film_thickness, limit)
