"""Vectors in space and rotation matrices, for kernels."""

import math
from typing import Any, NamedTuple

from ..compile.kernel import kernel
from ..core.quantities import Vector


class Arrow(NamedTuple):
    """A vector in space."""

    x: float
    y: float
    z: float


@kernel
def cross(a: Arrow, b: Arrow) -> Arrow:
    return Arrow(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x)


@kernel
def dot(a: Arrow, b: Arrow) -> float:
    return a.x * b.x + a.y * b.y + a.z * b.z


@kernel
def add(a: Arrow, b: Arrow) -> Arrow:
    return Arrow(a.x + b.x, a.y + b.y, a.z + b.z)


@kernel
def subtract(a: Arrow, b: Arrow) -> Arrow:
    return Arrow(a.x - b.x, a.y - b.y, a.z - b.z)


@kernel
def scale(factor: float, a: Arrow) -> Arrow:
    return Arrow(factor * a.x, factor * a.y, factor * a.z)


@kernel
def pick(a: Any) -> Arrow:
    """The first three elements of a vector."""
    return Arrow(a[0], a[1], a[2])


@kernel
def to_ground(rotation: Any, a: Arrow) -> Arrow:
    """R a."""
    return Arrow(
        rotation[0, 0] * a.x + rotation[0, 1] * a.y + rotation[0, 2] * a.z,
        rotation[1, 0] * a.x + rotation[1, 1] * a.y + rotation[1, 2] * a.z,
        rotation[2, 0] * a.x + rotation[2, 1] * a.y + rotation[2, 2] * a.z,
    )


@kernel
def to_body(rotation: Any, a: Arrow) -> Arrow:
    """R^T a."""
    return Arrow(
        rotation[0, 0] * a.x + rotation[1, 0] * a.y + rotation[2, 0] * a.z,
        rotation[0, 1] * a.x + rotation[1, 1] * a.y + rotation[2, 1] * a.z,
        rotation[0, 2] * a.x + rotation[1, 2] * a.y + rotation[2, 2] * a.z,
    )


@kernel
def fill_rotation(angles: Vector, rotation: Any) -> None:
    """R = R_x(alpha) R_y(beta) R_z(gamma) of the Cardan angles 1-2-3."""
    ca, sa = math.cos(angles[0]), math.sin(angles[0])
    cb, sb = math.cos(angles[1]), math.sin(angles[1])
    cg, sg = math.cos(angles[2]), math.sin(angles[2])
    rotation[0, 0], rotation[0, 1], rotation[0, 2] = cb * cg, -cb * sg, sb
    rotation[1, 0], rotation[1, 1], rotation[1, 2] = ca * sg + sa * sb * cg, ca * cg - sa * sb * sg, -sa * cb
    rotation[2, 0], rotation[2, 1], rotation[2, 2] = sa * sg - ca * sb * cg, sa * cg + ca * sb * sg, ca * cb


@kernel
def turn_angles(angles: Vector, omega: Arrow) -> Arrow:
    """Rates of the Cardan angles at the angular velocity omega, given in the axes of the ground.

    omega = alpha' e1 + beta' R_x e2 + gamma' R_x R_y e3; singular at beta = +-90 deg.
    """
    ca, sa = math.cos(angles[0]), math.sin(angles[0])
    third = (ca * omega.z - sa * omega.y) / math.cos(angles[1])
    return Arrow(omega.x - math.sin(angles[1]) * third, ca * omega.y + sa * omega.z, third)
