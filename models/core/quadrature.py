"""Integrals beside a motion: samples of it along each integration step that it makes.

`sample(weight, t, s, x, U, u, p, work)` is called at the points of a quadrature with the state x at t + s,
the inputs' polynomials U, and weights that add up to the time that passed. It may change u and its own part
of `work`; the motion does not see it.
"""

import math
from typing import Any

from ..compile.kernel import kernel
from .dormand_prince import Workspace, make_interpolate

# Lobatto's four points in [0, 1] and their weights: exact for polynomials of degree 5.
POINTS = (0.0, 0.5 - 0.5 / math.sqrt(5.0), 0.5 + 0.5 / math.sqrt(5.0), 1.0)
WEIGHTS = (1.0 / 12.0, 5.0 / 12.0, 5.0 / 12.0, 1.0 / 12.0)


@kernel
def _nothing(s: float, h: float, w: Workspace) -> None:
    return


def make_quadrature(sample: Any, n: int) -> Any:
    """quadrature(s, h, w): samples of the step of length h from w.x at w.t + s to w.xn; changes w.xt.

    Nothing happens where `sample` is None.
    """
    if sample is None:
        return _nothing
    interpolate = make_interpolate(n)

    @kernel
    def quadrature(s: float, h: float, w: Workspace) -> None:
        sample(WEIGHTS[0] * h, w.t, s, w.x, w.U, w.u, w.p, w.work)
        for j in range(1, len(POINTS) - 1):
            interpolate(POINTS[j], h, w)
            sample(WEIGHTS[j] * h, w.t, s + POINTS[j] * h, w.xt, w.U, w.u, w.p, w.work)
        sample(WEIGHTS[-1] * h, w.t, s + h, w.xn, w.U, w.u, w.p, w.work)

    return quadrature
