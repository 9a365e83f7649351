"""Second method: accelerations by the constraints' second derivatives (index 1), DOP853, projected steps.

Hairer and Wanner (1996), Solving Ordinary Differential Equations II, section VII.2. It shares the equations
with the first method, but neither the form nor the formulas, and uses gamma, which that one does not.
"""

from collections.abc import Callable

import numpy as np
from scipy.integrate import DOP853

from models.core.quantities import Vector
from models.multibody.equations import FILM, turn_coordinates
from models.multibody.ida import COORDINATE, VELOCITY
from models.multibody.mechanism import Mechanism
from models.multibody.motion import Motion, check_request, complete, explain_failure, explain_singular

Flow = Callable[[float, Vector], Vector]


def make_flow(mechanism: Mechanism, size: int) -> tuple[Flow, Flow]:
    """rate(t, y) = y' of y = (q, v, films), with `size` coordinates, and project(t, y) on the constraints."""

    def rate(t: float, y: Vector) -> Vector:
        q, v, film = y[:size].copy(), y[size : 2 * size].copy(), y[2 * size :].copy()
        change = np.empty_like(y)
        turn_coordinates(q, v, change)
        with explain_singular(mechanism, t, q, v):
            change[size : 2 * size] = mechanism.accelerate(t, q, v, film)[0]
        change[2 * size :] = mechanism.evaluate(t, q, v, film).film_rate
        return change

    def project(t: float, y: Vector) -> Vector:
        """The coordinates by one of Newton's steps."""
        q, v, change = y[:size].copy(), y[size : 2 * size].copy(), np.empty(size)
        with explain_singular(mechanism, t, q, v):
            held = mechanism.evaluate(t, q, v).held
            jacobian = held.jacobian
            turn_coordinates(q, jacobian.T @ np.linalg.solve(jacobian @ jacobian.T, held.value), change)
            v = mechanism.project_velocities(t, q - change, v)
        return np.concatenate([q - change, v, y[2 * size :]])

    return rate, project


def solve_projected(mechanism: Mechanism, times: Vector, tolerance: float = 1e-9) -> Motion:
    """Motion at `times` (s, ascending) from the start at the first of them; see `solve_ida`."""
    times = check_request(times, tolerance)
    start = mechanism.start(float(times[0]))
    size = start.q.size

    rate, project = make_flow(mechanism, size)
    sizes = np.repeat([COORDINATE, VELOCITY, FILM], [size, size, start.film.size])
    y0 = np.concatenate([start.q, start.v, start.film])
    method = DOP853(rate, float(times[0]), y0, float(times[-1]), rtol=tolerance, atol=tolerance * sizes)
    states = np.empty((times.size, y0.size))
    states[0], done = y0, 1
    while method.status == "running":
        reason = method.step()
        if method.status == "failed":
            raise explain_failure(
                mechanism, method.t, method.y[:size], method.y[size : 2 * size], str(reason)
            )
        between = method.dense_output()
        while done < times.size and times[done] <= method.t:
            states[done] = project(times[done], between(times[done]))
            done += 1
        method.y = project(method.t, method.y)
        method.f = rate(method.t, method.y)
    name = f"projected DOP853, relative tolerance {tolerance:g}"
    return complete(mechanism, times, states, name)
