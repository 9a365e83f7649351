"""The equations of motion: kernels that evaluate a mechanism, and the residual of its stabilised form."""

from functools import cache
from typing import Any

from ..compile.kernel import kernel
from ..core.integrator import copy
from ..core.quantities import Vector
from .constraints import Curve, constrain, find_cam_angle, follow_cam, lift_end
from .loads import load_field, load_spring, lubricate, press, push
from .tables import FLAT_CAM, Evaluation, Tables
from .vectors import Arrow, add, cross, fill_rotation, pick, scale, to_body, to_ground, turn_angles

# Share of a coordinate's or velocity's size by which the Jacobian's differences move it.
DIFFERENCE = 1e-7
# Size of a film (m).
FILM = 1e-6


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


@cache
def make_evaluate(lift: Any) -> Any:
    """The kernel evaluate(t, q, v, film, tables, evaluation); `lift` is the kernel of cam profiles."""

    @kernel
    def find_profile(e: Evaluation, row: Any, tables: Tables) -> Curve:
        """Of a cam, or of a lever's end."""
        psi = find_cam_angle(e, row)
        if row.kind == FLAT_CAM:
            cam = tables.cams[row.cam]
            return Curve(cam.base_radius, lift(psi, cam))
        return Curve(row.offset, lift_end(psi, row))

    @kernel
    def evaluate(t: float, q: Vector, v: Vector, film: Vector, tables: Tables, e: Evaluation) -> None:
        e.force[:], e.held.rate[:] = 0.0, 0.0
        place_bodies(q, v, e)
        for b in range(tables.mass.shape[0]):
            load_inertia(b, tables, e)
        for k in range(tables.rows.shape[0]):
            row = tables.rows[k]
            if row.kind < FLAT_CAM:
                constrain(t, e, e.held, k, row)
            else:
                follow_cam(e, e.held, k, row, find_profile(e, row, tables))
        films = film.shape[0]
        for k in range(films):
            row = tables.touches[k]
            curve = find_profile(e, row, tables)
            turning = follow_cam(e, e.touch, k, row, curve)
            lubricate(e, k, row, curve, turning, film[k], tables.lubricants[k])
        for k in range(films, tables.touches.shape[0]):
            row = tables.touches[k]
            if row.kind < FLAT_CAM:
                constrain(t, e, e.touch, k, row)
            else:
                follow_cam(e, e.touch, k, row, find_profile(e, row, tables))
            press(e, k, tables.presses[k - films])
        for k in range(tables.springs.shape[0]):
            load_spring(e, tables.springs[k])
        for k in range(tables.fields.shape[0]):
            load_field(e, tables.fields[k])

    return evaluate


@kernel
def turn_coordinates(q: Vector, v: Vector, rate: Vector) -> None:
    """q' = T(q) v."""
    for b in range(q.shape[0] // 6):
        first = 6 * b
        turned = turn_angles(q[first + 3 : first + 6], pick(v[first + 3 : first + 6]))
        for i in range(3):
            rate[first + i] = v[first + i]
        rate[first + 3], rate[first + 4], rate[first + 5] = turned.x, turned.y, turned.z


@kernel
def assemble(y: Vector, dy: Vector, tables: Tables, e: Evaluation, moved: Vector, r: Vector) -> None:
    """The residual of the stabilised form of index 2 (Gear, Gupta and Leimkuhler 1985), from an evaluation.

    With y = (q, v, h, lambda, mu), h the films:
    q' - T (v - J^T mu), M v' - f + J^T lambda, h' - h'(q, v, h), J v + C_t, C.
    """
    size, m, films = 6 * tables.mass.shape[0], tables.rows.shape[0], e.film_rate.shape[0]
    q, v, first = y[:size], y[size : 2 * size], 2 * size + films
    for k in range(films):
        r[2 * size + k] = dy[2 * size + k] - e.film_rate[k]
    for i in range(size):
        moved[i] = v[i]
        r[size + i] = -e.force[i]
        for j in range(6):
            r[size + i] += e.blocks[i // 6, i % 6, j] * dy[size + 6 * (i // 6) + j]
    for k in range(m):
        load, correction, rate = y[first + k], y[first + m + k], e.held.rate[k]
        for side in range(2):
            body = e.held.bodies[k, side]
            if body == 0:
                continue
            for i in range(6):
                share, at = e.held.entries[k, side, i], 6 * (body - 1) + i
                moved[at] -= share * correction
                r[size + at] += share * load
                rate += share * v[at]
        r[first + k] = rate
        r[first + m + k] = e.held.value[k]
    turn_coordinates(q, moved, r)
    for i in range(size):
        r[i] = dy[i] - r[i]


@cache
def make_residual(lift: Any) -> Any:
    """The kernel residual(t, y, dy, tables, evaluation, scratch, r); see `assemble`."""
    evaluate = make_evaluate(lift)

    @kernel
    def residual(
        t: float, y: Vector, dy: Vector, tables: Tables, e: Evaluation, moved: Vector, r: Vector
    ) -> None:
        size = 6 * tables.mass.shape[0]
        end = 2 * size + e.film_rate.shape[0]
        evaluate(t, y[:size], y[size : 2 * size], y[2 * size : end], tables, e)
        assemble(y, dy, tables, e, moved, r)

    return residual


@cache
def make_matrix(lift: Any) -> Any:
    """The kernel that fills dF/dy + c dF/dy' of the residual F, by differences of `least` or more."""
    residual = make_residual(lift)

    @kernel
    def matrix(
        t: float, c: float, y: Vector, dy: Vector, tables: Tables, e: Evaluation, least: Vector,
        scratch: Vector, out: Vector,
    ) -> None:  # fmt: skip
        moved, base, other, place, place_rate = scratch[0], scratch[1], scratch[2], scratch[3], scratch[4]
        residual(t, y, dy, tables, e, moved, base)
        copy(place, y)
        copy(place_rate, dy)
        multipliers = 12 * tables.mass.shape[0] + e.film_rate.shape[0]
        # From the last on: the multipliers change nothing that is evaluated.
        for j in range(y.shape[0] - 1, -1, -1):
            place[j] = y[j] + max(DIFFERENCE * abs(y[j]), least[j])
            change = place[j] - y[j]
            place_rate[j] = dy[j] + c * change
            if j >= multipliers:
                assemble(place, place_rate, tables, e, moved, other)
            else:
                residual(t, place, place_rate, tables, e, moved, other)
            for i in range(y.shape[0]):
                out[i, j] = (other[i] - base[i]) / change
            place[j], place_rate[j] = y[j], dy[j]

    return matrix
