"""Dimensionless groups of the line contact."""

from typing import Any, NamedTuple

from ...compile.kernel import kernel


class Conditions(NamedTuple):
    """What a film forms under, besides the load: entraining velocity u (m/s), reduced radius R and length
    L_c (m), compliance (1/Pa), viscosity eta0 (Pa s) and pressure-viscosity coefficient alpha (1/Pa)."""

    velocity: float
    radius: float
    length: float
    compliance: float
    viscosity: float
    pressure_viscosity: float


class Groups(NamedTuple):
    """Speed U = eta |u| / (E R), load W = w / (E R L), material G = alpha E, for a modulus E."""

    speed: float
    load: float
    material: float


@kernel
def find_conditions(u: Any, compliance: float, p: Any) -> Conditions:
    """Of a contact's inputs and parameters."""
    return Conditions(
        u.entraining_velocity, u.radius_of_curvature, p.length, compliance, p.viscosity, p.pressure_viscosity
    )


@kernel
def groups(modulus: float, load: float, at: Conditions) -> Groups:
    return Groups(
        at.viscosity * abs(at.velocity) / (modulus * at.radius),
        load / (modulus * at.radius * at.length),
        at.pressure_viscosity * modulus,
    )
