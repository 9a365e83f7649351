"""The numbers of a mechanism as arrays, for kernels. Body 0 is the ground."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from ..core.quantities import Vector

# Kinds of scalar constraints.
PERPENDICULAR, AHEAD, DRIVEN, FLAT_CAM = range(4)

# One scalar constraint between the bodies i and j. `a` and the point p_i are fixed in i, `b` and p_j in j.
ROW = np.dtype(
    [
        ("kind", "i8"),
        ("i", "i8"),
        ("j", "i8"),
        ("a", "f8", 3),
        ("a2", "f8", 3),
        ("b", "f8", 3),
        ("p_i", "f8", 3),
        ("p_j", "f8", 3),
        ("offset", "f8"),  # of AHEAD (m)
        ("angle", "f8"),  # of DRIVEN at t = 0 (rad), with its speed and acceleration
        ("speed", "f8"),
        ("acceleration", "f8"),
        ("cam", "i8"),  # number of the cam's profile
    ]
)
# A spring and damper along the line between two points.
SPRING = np.dtype(
    [
        ("i", "i8"),
        ("j", "i8"),
        ("p_i", "f8", 3),
        ("p_j", "f8", 3),
        ("length", "f8"),  # without force
        ("stiffness", "f8"),
        ("damping", "f8"),
    ]
)
# An elastic field between a frame of i and one of j, whose axes are the columns of e_i and e_j.
FIELD = np.dtype(
    [
        ("i", "i8"),
        ("j", "i8"),
        ("p_i", "f8", 3),
        ("p_j", "f8", 3),
        ("e_i", "f8", (3, 3)),
        ("e_j", "f8", (3, 3)),
        ("rest", "f8", 3),  # of the displacement
        ("stiffness", "f8", (6, 6)),
        ("damping", "f8", (6, 6)),
    ]
)


class Tables(NamedTuple):
    """n moving bodies, m scalar constraints."""

    mass: Vector  # (n,)
    inertia: Vector  # (n, 3), in the body's axes
    gravity: Vector  # (3,)
    rows: Any  # (m,) of ROW
    springs: Any  # of SPRING
    fields: Any  # of FIELD
    touches: Any  # (c,) of ROW: flat cams with an oil film
    lubricants: Any  # records of their contacts' parameters; at least one, which may be unused
    cams: Any  # records of the cams' parameters; at least one, which may be unused


class Rows(NamedTuple):
    """Scalar constraints at an instant: C, J, C_t, gamma."""

    value: Vector  # (m,)
    jacobian: Vector  # (m, 6 n)
    rate: Vector  # (m,)
    gamma: Vector  # (m,)


class Evaluation(NamedTuple):
    """The equations of a mechanism at an instant; the kernel `evaluate` fills it.

    The velocities are, of each body, that of its centre of mass and its angular velocity, both in the axes
    of the ground. M v' = f - J^T lambda, C = 0, J v + C_t = 0, J v' = gamma.
    """

    position: Vector  # (n + 1, 3)
    rotation: Vector  # (n + 1, 3, 3)
    velocity: Vector  # (n + 1, 3)
    omega: Vector  # (n + 1, 3)
    mass: Vector  # M, (6 n, 6 n), block diagonal
    force: Vector  # f, (6 n,), with the gyroscopic moments
    held: Rows  # of the joints
    touch: Rows  # overlaps of the c contacts
    load: Vector  # of the contacts, (c,)
    film_rate: Vector  # (c,)


def make_rows(bodies: int, count: int) -> Rows:
    """Storage for so many constraints."""
    return Rows(np.zeros(count), np.zeros((count, 6 * bodies)), np.zeros(count), np.zeros(count))


def make_evaluation(bodies: int, constraints: int, contacts: int) -> Evaluation:
    """Storage for the equations; the ground rests."""
    rotation = np.zeros((bodies + 1, 3, 3))
    rotation[0] = np.eye(3)
    return Evaluation(
        position=np.zeros((bodies + 1, 3)),
        rotation=rotation,
        velocity=np.zeros((bodies + 1, 3)),
        omega=np.zeros((bodies + 1, 3)),
        mass=np.zeros((6 * bodies, 6 * bodies)),
        force=np.zeros(6 * bodies),
        held=make_rows(bodies, constraints),
        touch=make_rows(bodies, contacts),
        load=np.zeros(contacts),
        film_rate=np.zeros(contacts),
    )
