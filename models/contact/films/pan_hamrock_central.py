"""Central film of Pan and Hamrock."""

from ...compile.kernel import kernel
from .groups import groups


@kernel
def film(
    load: float, velocity: float, radius: float, length: float, compliance: float,
    viscosity: float, pressure_viscosity: float,
) -> float:  # fmt: skip
    """h = 2.922 R G^0.470 U^0.692 W^-0.166, E' = 2 / compliance."""
    g = groups(2.0 / compliance, load, velocity, radius, length, viscosity, pressure_viscosity)
    return 2.922 * radius * g.material**0.470 * g.speed**0.692 * g.load**-0.166
