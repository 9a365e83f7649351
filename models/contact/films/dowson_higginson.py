"""Minimum film of Dowson and Higginson."""

from ...compile.kernel import kernel
from .groups import groups


@kernel
def film(
    load: float, velocity: float, radius: float, length: float, compliance: float,
    viscosity: float, pressure_viscosity: float,
) -> float:  # fmt: skip
    """h = 2.65 R G^0.54 U^0.70 W^-0.13, E' = 2 / compliance."""
    g = groups(2.0 / compliance, load, velocity, radius, length, viscosity, pressure_viscosity)
    return 2.65 * radius * g.material**0.54 * g.speed**0.70 * g.load**-0.13
