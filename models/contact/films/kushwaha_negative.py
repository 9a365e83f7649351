"""Kushwaha et al. 2000, equation (10), with the negative load exponent that physics wants."""

import math

from ...compile.kernel import kernel
from .groups import groups


@kernel
def film(
    load: float, velocity: float, radius: float, length: float, compliance: float,
    viscosity: float, pressure_viscosity: float,
) -> float:  # fmt: skip
    """h = 1.67 R W^-0.059 U^0.541 G^0.421 (K 10, sign of the load exponent changed)."""
    g = groups(math.pi / compliance, load, velocity, radius, length, viscosity, pressure_viscosity)
    return 1.67 * radius * g.load**-0.059 * g.speed**0.541 * g.material**0.421
