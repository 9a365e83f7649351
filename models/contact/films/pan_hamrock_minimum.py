"""Minimum film of Pan and Hamrock."""

from ...compile.kernel import kernel
from .groups import groups


@kernel
def film(
    load: float, velocity: float, radius: float, length: float, compliance: float,
    viscosity: float, pressure_viscosity: float,
) -> float:  # fmt: skip
    """h = 1.714 R G^0.568 U^0.694 W^-0.128, E' = 2 / compliance."""
    g = groups(2.0 / compliance, load, velocity, radius, length, viscosity, pressure_viscosity)
    return 1.714 * radius * g.material**0.568 * g.speed**0.694 * g.load**-0.128
