"""No film: a dry Hertzian contact."""

from ...compile.kernel import kernel


@kernel
def film(
    load: float, velocity: float, radius: float, length: float, compliance: float,
    viscosity: float, pressure_viscosity: float,
) -> float:  # fmt: skip
    """h = 0."""
    return 0.0
