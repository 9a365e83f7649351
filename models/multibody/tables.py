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
    cams: Any  # records of the cams' parameters; at least one, which may be unused


class Evaluation(NamedTuple):
    """A mechanism's equations at an instant; the kernel `evaluate` fills it.

    The velocities are, of each body, that of its centre of mass and its angular velocity, both in the axes
    of the ground. M v' = f - J^T lambda, C = 0, J v + C_t = 0, J v' = gamma.
    """

    position: Vector  # (n + 1, 3)
    rotation: Vector  # (n + 1, 3, 3)
    velocity: Vector  # (n + 1, 3)
    omega: Vector  # (n + 1, 3)
    mass: Vector  # M, (6 n, 6 n), block diagonal
    force: Vector  # f, (6 n,), with the gyroscopic moments
    constraint: Vector  # C, (m,)
    jacobian: Vector  # J, (m, 6 n)
    rate: Vector  # C_t, (m,)
    gamma: Vector  # (m,)


def make_evaluation(bodies: int, constraints: int) -> Evaluation:
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
        constraint=np.zeros(constraints),
        jacobian=np.zeros((constraints, 6 * bodies)),
        rate=np.zeros(constraints),
        gamma=np.zeros(constraints),
    )
