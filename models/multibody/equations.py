"""The equations of motion: kernels that evaluate a mechanism, and the residual of its stabilised form."""

from functools import cache
from typing import Any

from ..compile.kernel import kernel
from ..core.quantities import Vector
from .constraints import Curve, constrain, find_cam_angle, follow_cam, lift_end
from .loads import load_field, load_spring, press
from .lubrication import lubricate
from .pattern import Pattern
from .rigid import load_inertia, place_bodies
from .tables import FLAT_CAM, Evaluation, Tables
from .vectors import pick, turn_angles

# Share of a coordinate's or velocity's size by which the Jacobian's differences move it.
DIFFERENCE = 1e-7
# Size of a film (m).
FILM = 1e-6


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


@cache
def make_residual(lift: Any) -> Any:
    """The kernel of the stabilised form of index 2 (Gear, Gupta and Leimkuhler 1985).

    With y = (q, v, h, lambda, mu), h the films:
    q' - T (v - J^T mu), M v' - f + J^T lambda, h' - h'(q, v, h), J v + C_t, C.
    """
    evaluate = make_evaluate(lift)

    @kernel
    def residual(
        t: float, y: Vector, dy: Vector, tables: Tables, e: Evaluation, moved: Vector, r: Vector
    ) -> None:
        size, m, films = 6 * tables.mass.shape[0], tables.rows.shape[0], e.film_rate.shape[0]
        q, v = y[:size], y[size : 2 * size]
        first = 2 * size + films
        evaluate(t, q, v, y[2 * size : first], tables, e)
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

    return residual


@cache
def make_matrix(lift: Any) -> Any:
    """The kernel that fills the entries of dF/dy + c dF/dy' of the residual F, by differences.

    Columns of one colour have no row in common and share one evaluation of F.
    """
    residual = make_residual(lift)

    @kernel
    def matrix(
        t: float,
        c: float,
        y: Vector,
        dy: Vector,
        tables: Tables,
        e: Evaluation,
        pattern: Pattern,
        scratch: Vector,
        out: Vector,
    ) -> None:
        moved, base, other, place = scratch[0], scratch[1], scratch[2], scratch[3]
        place_rate, change = scratch[4], scratch[5]
        residual(t, y, dy, tables, e, moved, base)
        place[:], place_rate[:] = y, dy
        for colour in range(pattern.first.shape[0] - 1):
            columns = pattern.columns[pattern.first[colour] : pattern.first[colour + 1]]
            for j in columns:
                step = max(DIFFERENCE * abs(y[j]), pattern.steps[j])
                place[j] = y[j] + step
                change[j] = place[j] - y[j]
                place_rate[j] = dy[j] + c * change[j]
            residual(t, place, place_rate, tables, e, moved, other)
            for j in columns:
                for k in range(pattern.starts[j], pattern.starts[j + 1]):
                    i = pattern.rows[k]
                    out[k] = (other[i] - base[i]) / change[j]
                place[j], place_rate[j] = y[j], dy[j]

    return matrix
