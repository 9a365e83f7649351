"""Central film of Dowson and Toyoda."""

from ...compile.kernel import kernel
from .groups import groups


@kernel
def film(
    load: float, velocity: float, radius: float, length: float, compliance: float,
    viscosity: float, pressure_viscosity: float,
) -> float:  # fmt: skip
    """h = 3.06 R G^0.56 U^0.69 W^-0.10, E' = 2 / compliance."""
    g = groups(2.0 / compliance, load, velocity, radius, length, viscosity, pressure_viscosity)
    return 3.06 * radius * g.material**0.56 * g.speed**0.69 * g.load**-0.10
