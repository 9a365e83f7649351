"""The numbers of a mechanism as arrays, for kernels. Body 0 is the ground."""

from typing import Any, NamedTuple

import numpy as np

from ..core.quantities import Vector

# Kinds of scalar constraints.
PERPENDICULAR, AHEAD, DRIVEN, FLAT_CAM, LEVER, PAD = range(6)

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
        ("offset", "f8"),  # of AHEAD; base radius of LEVER and PAD (m)
        ("angle", "f8"),  # of DRIVEN at t = 0 (rad), with its speed and acceleration
        ("speed", "f8"),
        ("acceleration", "f8"),
        ("cam", "i8"),  # number of the cam's profile
        ("arm", "f8"),  # of LEVER and PAD (m), which falls by the tilt (rad)
        ("tilt", "f8"),
    ]
)


def find_drive_angle(drive: Any, t: float) -> float:
    """The angle (rad) of a DRIVEN constraint at t, from its fields or its row."""
    return float(drive["angle"] + (drive["speed"] + 0.5 * drive["acceleration"] * t) * t)


# The law W = k C + c C' of a contact; one that is not bonded never pulls.
PRESS = np.dtype([("stiffness", "f8"), ("damping", "f8"), ("bonded", "f8")])
# Of an element between two points.
_ENDS = [("i", "i8"), ("j", "i8"), ("at_i", "f8", 3), ("at_j", "f8", 3)]
# A spring and damper along the line between them; its length is that without force.
SPRING = np.dtype([*_ENDS, ("length", "f8"), ("stiffness", "f8"), ("damping", "f8")])
# An elastic field between a frame of i and one of j, whose axes are the columns of axes_i and axes_j.
FIELD = np.dtype(
    [
        *_ENDS,
        ("axes_i", "f8", (3, 3)),
        ("axes_j", "f8", (3, 3)),
        ("rest", "f8", 3),  # of the displacement
        ("stiffness", "f8", (6, 6)),
        ("damping", "f8", (6, 6)),
    ]
)


class Tables(NamedTuple):
    """n moving bodies, m scalar constraints."""

    mass: Vector  # (n,)
    inertia: Vector  # (n, 3), in the body's axes
    moment: Vector  # (n, 3), applied, in the axes of the ground
    gravity: Vector  # (3,)
    rows: Any  # (m,) of ROW
    springs: Any  # of SPRING
    fields: Any  # of FIELD
    touches: Any  # (c,) of ROW: contacts that are not held, first those with an oil film
    lubricants: Any  # records of the films' parameters; at least one, which may be unused
    presses: Any  # of PRESS: the laws of the other contacts
    cams: Any  # records of the cams' parameters; at least one, which may be unused


class Rows(NamedTuple):
    """Scalar constraints at an instant: C, J, C_t, gamma.

    A row of J has entries at two bodies only; the ground, body 0, has none in J.
    """

    value: Vector  # (m,)
    entries: Vector  # (m, 2, 6), at the velocities of i and of j
    rate: Vector  # (m,)
    gamma: Vector  # (m,)
    bodies: Any  # (m, 2), i and j
    moving: Vector  # (n,), for its length

    @property
    def jacobian(self) -> Vector:
        """J, (m, 6 n)."""
        full = np.zeros((self.value.size, self.moving.size + 1, 6))
        for side in (0, 1):
            full[np.arange(self.value.size), self.bodies[:, side]] += self.entries[:, side]
        return full[:, 1:].reshape(self.value.size, 6 * self.moving.size)


class Evaluation(NamedTuple):
    """The equations of a mechanism at an instant; the kernel `evaluate` fills it.

    The velocities are, of each body, that of its centre of mass and its angular velocity, both in the axes
    of the ground. M v' = f - J^T lambda, C = 0, J v + C_t = 0, J v' = gamma.
    """

    position: Vector  # (n + 1, 3)
    rotation: Vector  # (n + 1, 3, 3)
    velocity: Vector  # (n + 1, 3)
    omega: Vector  # (n + 1, 3)
    blocks: Vector  # of the bodies in M, (n, 6, 6)
    force: Vector  # f, (6 n,), with the gyroscopic moments
    held: Rows  # of the joints
    touch: Rows  # overlaps of the c contacts
    load: Vector  # of the contacts, (c,)
    film_rate: Vector  # of the contacts with a film

    @property
    def mass(self) -> Vector:
        """M, (6 n, 6 n)."""
        own, bodies = np.arange(len(self.blocks)), len(self.blocks)
        full = np.zeros((bodies, 6, bodies, 6))
        full[own, :, own] = self.blocks
        return full.reshape(6 * bodies, 6 * bodies)


def make_rows(tables: Tables, rows: Any) -> Rows:
    """Storage for these rows."""
    count, ends = len(rows), np.stack([rows["i"], rows["j"]], axis=1)
    value, rate, gamma = np.zeros((3, count))
    return Rows(value, np.zeros((count, 2, 6)), rate, gamma, ends, np.zeros(len(tables.mass)))


def make_evaluation(tables: Tables) -> Evaluation:
    """Storage for the equations; the ground rests."""
    bodies = len(tables.mass)
    rotation = np.zeros((bodies + 1, 3, 3))
    rotation[0] = np.eye(3)
    return Evaluation(
        position=np.zeros((bodies + 1, 3)),
        rotation=rotation,
        velocity=np.zeros((bodies + 1, 3)),
        omega=np.zeros((bodies + 1, 3)),
        blocks=np.zeros((bodies, 6, 6)),
        force=np.zeros(6 * bodies),
        held=make_rows(tables, tables.rows),
        touch=make_rows(tables, tables.touches),
        load=np.zeros(len(tables.touches)),
        film_rate=np.zeros(len(tables.touches) - len(tables.presses)),
    )
