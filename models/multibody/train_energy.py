"""Energies of the direct train: stored, dissipated, and from sources inside."""

import math
from typing import Any

import numpy as np

from ..compile.kernel import kernel
from ..contact.hertz import elastic_energy, pair_compliance
from ..core.quantities import Vector
from ..valve_train.valve_spring import Lumping
from .constraints import carry, differ, point_at
from .loads import bend_field
from .multipliers import multiply_row
from .train_kernels import DRIVE_ROW, Fixed, Spring, Train, make_spring
from .vectors import Arrow, dot, pick, to_body


@kernel
def kinetic_energy(train: Train) -> float:
    total = 0.0
    for b in range(train.inertia.mass.shape[0]):
        v, own = pick(train.e.velocity[b + 1]), train.inertia.inertia[b]
        w = to_body(train.e.rotation[b + 1], pick(train.e.omega[b + 1]))
        total += train.inertia.mass[b] * dot(v, v)
        total += own[0] * w.x**2 + own[1] * w.y**2 + own[2] * w.z**2
    return 0.5 * total


@kernel
def multiply_twice(matrix: Any, shift: Arrow, turn: Arrow) -> float:
    """x^T K x of x = (shift, turn)."""
    x = np.array([shift.x, shift.y, shift.z, turn.x, turn.y, turn.z])
    total = 0.0
    for i in range(6):
        for j in range(6):
            total += x[i] * matrix[i, j] * x[j]
    return total


@kernel
def lengthen(e: Any, s: Spring) -> Any:
    """Length of a spring and its rate."""
    d = differ(point_at(e, s.j, carry(e, s.j, s.p_j)), point_at(e, s.i, carry(e, s.i, s.p_i)))
    length = math.sqrt(dot(d.value, d.value))
    return length, dot(d.value, d.rate) / length


@kernel
def fill_energy(train: Train, coils: int, lumping: Lumping, fixed: Fixed, u: Any, p: Any, e: Vector) -> None:
    """Stored: of motion, springs, shaft and contact. Dissipated: by their damping. Source: the growing film.

    What restores a violated constraint is a source too: all power of the multipliers but that of the drive.
    """
    stored, lost = kinetic_energy(train), 0.0
    for k in range(coils + 1):
        s = make_spring(k, coils, lumping, fixed, p)
        length, rate = lengthen(train.e, s)
        stored += 0.5 * s.stiffness * (length - s.length) ** 2
        lost += s.damping * rate**2
    if p.flexible != 0.0:
        bent = bend_field(train.e, train.field)
        stored += 0.5 * multiply_twice(train.field.stiffness, bent.shift, bent.turn)
        lost += multiply_twice(train.field.damping, bent.shift_rate, bent.turn_rate)
    radius = train.surfaces.radius_of_curvature
    stored += elastic_energy(train.elastic_load, radius, p.length, pair_compliance(p))
    lost += (train.load - train.elastic_load) * train.deflection_rate
    source = train.load * u.film_rate - train.multipliers[DRIVE_ROW] * train.drive.speed
    for k in range(train.multipliers.shape[0]):
        source -= train.multipliers[k] * multiply_row(train.e.held, k, train.v)
    e[0], e[1], e[2] = stored, lost, source
