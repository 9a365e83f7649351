"""Rahnejat's central film as Kushwaha et al. 2000 print it, equation (10), without its squeeze term.

E = pi / compliance. The printed load exponent is +0.059; physics wants it negative, the size of the film
wants it positive. The squeeze term becomes the relaxation equation of `ehl_contact`.
"""

import math

from ...compile.kernel import kernel
from .groups import groups


@kernel
def film(
    load: float, velocity: float, radius: float, length: float, compliance: float,
    viscosity: float, pressure_viscosity: float,
) -> float:  # fmt: skip
    """h = 1.67 R W^0.059 U^0.541 G^0.421 (K 10, exponent as printed)."""
    g = groups(math.pi / compliance, load, velocity, radius, length, viscosity, pressure_viscosity)
    return 1.67 * radius * g.load**0.059 * g.speed**0.541 * g.material**0.421


@kernel
def negative_film(
    load: float, velocity: float, radius: float, length: float, compliance: float,
    viscosity: float, pressure_viscosity: float,
) -> float:  # fmt: skip
    """h = 1.67 R W^-0.059 U^0.541 G^0.421 (K 10, sign of the load exponent changed)."""
    g = groups(math.pi / compliance, load, velocity, radius, length, viscosity, pressure_viscosity)
    return 1.67 * radius * g.load**-0.059 * g.speed**0.541 * g.material**0.421
