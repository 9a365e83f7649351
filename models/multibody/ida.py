"""First method: the stabilised form of index 2, by SUNDIALS IDA (backward differences of order 1 to 5)."""

from typing import Any

import numpy as np
from sksundae.ida import IDA

from ..core.quantities import Vector
from .equations import FILM, make_matrix, make_residual
from .mechanism import Mechanism
from .motion import Motion, check_request, complete, explain_failure
from .tables import make_evaluation

# Sizes below which an error is not weighed by what it belongs to: m or rad, m/s or rad/s.
COORDINATE, VELOCITY = 1e-2, 1.0
# The multipliers of the method choose neither its steps nor its iterations (N): in short steps they hold the
# rounding of the velocities over the step, and `complete` finds them from the motion.
MULTIPLIER = 1e12
# Least differences of the matrix: of coordinates (m, rad) and velocities, films (m) and multipliers (N, N m).
LEAST = (1e-9, 1e-13, 1.0)
STEP_LIMIT = 1_000_000


def solve_ida(mechanism: Mechanism, times: Vector, tolerance: float = 1e-9) -> Motion:
    """Motion at `times` (s, ascending) from the start at the first of them.

    `tolerance` is relative for each step. Raises ModelError, with the joint, where a mechanism locks.
    """
    times = check_request(times, tolerance)
    start = mechanism.start(float(times[0]))
    size, m = start.q.size, start.multipliers.size
    films = start.film.size
    first = 2 * size + films
    tables, e = mechanism.tables, make_evaluation(mechanism.tables)
    residual, matrix = make_residual(mechanism.profile.lift), make_matrix(mechanism.profile.lift)
    width = first + 2 * m
    # SUNDIALS hands out read-only views, for which numba would compile every kernel once more.
    own, own_rate, moved, scratch = np.empty(width), np.empty(width), np.empty(width), np.empty((5, width))
    least, entries = np.repeat(LEAST, [2 * size, films, 2 * m]), np.empty((width, width), order="F")

    def fill_residual(t: float, y: Vector, dy: Vector, out: Vector) -> None:
        own[:], own_rate[:] = y, dy
        residual(t, own, own_rate, tables, e, moved, out)

    def fill_matrix(t: float, y: Vector, dy: Vector, r: Vector, c: float, out: Any) -> None:
        own[:], own_rate[:] = y, dy
        matrix(t, c, own, own_rate, tables, e, least, scratch, entries)
        out[:] = entries

    y0, dy0 = np.zeros(width), np.zeros(width)
    y0[:first], y0[first : first + m] = np.concatenate([start.q, start.v, start.film]), start.multipliers
    fill_residual(float(times[0]), y0, dy0, scratch[0])
    dy0[:first] = -scratch[0, :first]
    dy0[size : 2 * size] = start.a
    sizes = np.repeat([COORDINATE, VELOCITY, FILM, MULTIPLIER], [size, size, films, 2 * m])
    solver = IDA(
        fill_residual,
        jacfn=fill_matrix,
        rtol=tolerance,
        atol=tolerance * sizes,
        algebraic_idx=list(range(first, width)),
        max_num_steps=STEP_LIMIT,
    )
    # Of an interval without an instant inside the solver returns all its steps.
    inside = times if times.size > 2 else np.linspace(times[0], times[-1], 3)
    result = solver.solve(inside, y0, dy0)
    y = np.asarray(result.y)
    if not result.success:
        raise explain_failure(
            mechanism, float(result.t[-1]), y[-1, :size], y[-1, size : 2 * size], result.message
        )
    name = f"IDA, stabilised form of index 2, relative tolerance {tolerance:g}"
    y = y if times.size > 2 else y[::2]
    return complete(mechanism, times, y[:, :first], name)
