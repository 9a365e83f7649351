"""Accelerations and multipliers in kernels: M a + J^T lambda = f, J a = gamma, by the Schur complement.

J M^-1 J^T lambda = J M^-1 f - gamma. Its matrix is positive definite where no constraint is redundant, so
that Cholesky's factors do; M^-1 of a rigid body is known.
"""

import math
from typing import Any, NamedTuple

import numpy as np

from ..compile.kernel import kernel
from ..core.quantities import Vector
from .tables import Evaluation, Rows
from .vectors import Arrow, to_body, to_ground


class Inertia(NamedTuple):
    """Of rigid bodies, as `load_inertia` reads it."""

    mass: Vector  # (n,)
    inertia: Vector  # (n, 3), in the body's axes
    moment: Vector  # (n, 3), applied, in the axes of the ground
    gravity: Vector  # (3,)


class Motion(NamedTuple):
    """What the equations of motion give: a (6 n,), lambda (m,)."""

    acceleration: Vector
    multipliers: Vector


@kernel
def divide_by_mass(inertia: Inertia, e: Evaluation, body: int, load: Any, out: Any) -> None:
    """out = M^-1 load of one body; both have six elements."""
    own, rotation = inertia.inertia[body - 1], e.rotation[body]
    moment = to_body(rotation, Arrow(load[3], load[4], load[5]))
    turned = to_ground(rotation, Arrow(moment.x / own[0], moment.y / own[1], moment.z / own[2]))
    for i in range(3):
        out[i] = load[i] / inertia.mass[body - 1]
    out[3], out[4], out[5] = turned.x, turned.y, turned.z


@kernel
def multiply_row(rows: Rows, k: int, velocities: Vector) -> float:
    """J_k v."""
    total = 0.0
    for side in range(2):
        body = rows.bodies[k, side]
        for i in range(6):
            if body > 0:
                total += rows.entries[k, side, i] * velocities[6 * (body - 1) + i]
    return total


@kernel
def multiply_rows(rows: Rows, shares: Any, k: int, l: int) -> float:
    """J_l M^-1 J_k^T with M^-1 J_k^T in `shares`."""
    total = 0.0
    for side in range(2):
        body = rows.bodies[k, side]
        for other in range(2):
            if body > 0 and rows.bodies[l, other] == body:
                for i in range(6):
                    total += rows.entries[l, other, i] * shares[k, side, i]
    return total


@kernel
def factorise(matrix: Any) -> None:
    """Cholesky's lower factor in place of a positive definite matrix; not a number if it is not."""
    for k in range(matrix.shape[0]):
        for i in range(k + 1):
            left = matrix[k, i]
            for j in range(i):
                left -= matrix[k, j] * matrix[i, j]
            matrix[k, i] = left / matrix[i, i] if i < k else math.sqrt(left)


@kernel
def substitute(factor: Any, x: Vector) -> None:
    """x = (L L^T)^-1 x."""
    size = x.shape[0]
    for k in range(size):
        for j in range(k):
            x[k] -= factor[k, j] * x[j]
        x[k] /= factor[k, k]
    for k in range(size - 1, -1, -1):
        for j in range(k + 1, size):
            x[k] -= factor[j, k] * x[j]
        x[k] /= factor[k, k]


@kernel
def solve_motion(inertia: Inertia, e: Evaluation, gamma: Vector) -> Motion:
    """Accelerations and multipliers of rigid bodies that the rows of `e.held` hold."""
    m, bodies = e.held.value.shape[0], inertia.mass.shape[0]
    shares, matrix = np.empty((m, 2, 6)), np.empty((m, m))
    a, multipliers = np.empty(6 * bodies), np.empty(m)
    for b in range(bodies):
        divide_by_mass(inertia, e, b + 1, e.force[6 * b : 6 * b + 6], a[6 * b : 6 * b + 6])
    for k in range(m):
        for side in range(2):
            body = e.held.bodies[k, side]
            if body > 0:
                divide_by_mass(inertia, e, body, e.held.entries[k, side], shares[k, side])
        multipliers[k] = multiply_row(e.held, k, a) - gamma[k]
        for l in range(k + 1):
            matrix[k, l] = multiply_rows(e.held, shares, k, l)
    factorise(matrix)
    substitute(matrix, multipliers)
    for k in range(m):
        for side in range(2):
            body = e.held.bodies[k, side]
            if body > 0:
                for i in range(6):
                    a[6 * (body - 1) + i] -= shares[k, side, i] * multipliers[k]
    return Motion(a, multipliers)
