"""Places and inertia of rigid bodies, in kernels."""

from typing import Any

from ..compile.kernel import kernel
from ..core.quantities import Vector
from .loads import push
from .tables import Evaluation
from .vectors import Arrow, add, cross, fill_rotation, pick, scale, to_body, to_ground


@kernel
def place_bodies(q: Vector, v: Vector, e: Evaluation) -> None:
    for b in range(q.shape[0] // 6):
        for i in range(3):
            e.position[b + 1, i] = q[6 * b + i]
            e.velocity[b + 1, i] = v[6 * b + i]
            e.omega[b + 1, i] = v[6 * b + 3 + i]
        fill_rotation(q[6 * b + 3 : 6 * b + 6], e.rotation[b + 1])


@kernel
def load_inertia(b: int, tables: Any, e: Evaluation) -> None:
    """M of the body b and its loads: weight, applied moment, and -omega x I omega."""
    mass, own, rotation = tables.mass[b], tables.inertia[b], e.rotation[b + 1]
    for i in range(3):
        e.blocks[b, i, i] = mass
        for j in range(3):
            e.blocks[b, 3 + i, 3 + j] = (
                rotation[i, 0] * own[0] * rotation[j, 0]
                + rotation[i, 1] * own[1] * rotation[j, 1]
                + rotation[i, 2] * own[2] * rotation[j, 2]
            )
    omega = pick(e.omega[b + 1])
    w = to_body(rotation, omega)
    momentum = to_ground(rotation, Arrow(own[0] * w.x, own[1] * w.y, own[2] * w.z))
    moment = add(cross(momentum, omega), pick(tables.moment[b]))
    push(e, b + 1, scale(mass, pick(tables.gravity)), moment)
