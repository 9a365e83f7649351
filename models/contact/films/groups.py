"""Dimensionless groups of the line contact."""

from typing import NamedTuple

from ...compile.kernel import kernel


class Groups(NamedTuple):
    """Speed U = eta u / (E R), load W = w / (E R L), material G = alpha E, for a modulus E."""

    speed: float
    load: float
    material: float


@kernel
def groups(
    modulus: float, load: float, velocity: float, radius: float, length: float,
    viscosity: float, pressure_viscosity: float,
) -> Groups:  # fmt: skip
    return Groups(
        viscosity * velocity / (modulus * radius),
        load / (modulus * radius * length),
        pressure_viscosity * modulus,
    )
