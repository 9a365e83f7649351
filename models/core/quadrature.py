"""Integrals beside a motion: samples of it along each integration step that it makes.

`sample(weight, t, s, x, U, u, p, work)` is called at the points of a quadrature with the state x at t + s,
the inputs' polynomials U, and weights that add up to the time that passed. It may change u and its own part
of `work`; the motion does not see it.
"""

from __future__ import annotations

import math
from typing import Any

from ..compile.kernel import kernel

# Lobatto's four points in [0, 1] and their weights: exact for polynomials of degree 5.
POINTS = (0.0, 0.5 - 0.5 / math.sqrt(5.0), 0.5 + 0.5 / math.sqrt(5.0), 1.0)
WEIGHTS = (1.0 / 12.0, 5.0 / 12.0, 5.0 / 12.0, 1.0 / 12.0)


def make_interpolate(n: int) -> Any:
    """interpolate(f, h, x, xn, k, xd): the state xd at fraction f of a step from x to xn.

    The fourth-order continuation of Hairer, Norsett and Wanner, Solving Ordinary Differential Equations I,
    II.6; k holds the step's seven derivatives.
    """

    @kernel
    def interpolate(f: float, h: float, x: Any, xn: Any, k: Any, xd: Any) -> None:
        g = 1.0 - f
        for i in range(n):
            change = xn[i] - x[i]
            start = h * k[i] - change
            end = change - h * k[6 * n + i] - start
            bend = h * (
                -12715105075.0 / 11282082432.0 * k[i]
                + 87487479700.0 / 32700410799.0 * k[2 * n + i]
                - 10690763975.0 / 1880347072.0 * k[3 * n + i]
                + 701980252875.0 / 199316789632.0 * k[4 * n + i]
                - 1453857185.0 / 822651844.0 * k[5 * n + i]
                + 69997945.0 / 29380423.0 * k[6 * n + i]
            )
            xd[i] = x[i] + f * (change + g * (start + f * (end + g * bend)))

    return interpolate


@kernel
def _nothing(
    t: float, s: float, h: float, x: Any, xn: Any, k: Any, U: Any, u: Any, p: Any, xd: Any, work: Any
) -> None:
    return


def make_quadrature(sample: Any, n: int) -> Any:
    """quadrature(t, s, h, x, xn, k, U, u, p, xd, work): samples of the step from x at t + s to xn.

    k holds the step's seven derivatives; xd is room for a state. Nothing happens where `sample` is None.
    """
    if sample is None:
        return _nothing
    interpolate = make_interpolate(n)

    @kernel
    def quadrature(
        t: float, s: float, h: float, x: Any, xn: Any, k: Any, U: Any, u: Any, p: Any, xd: Any, work: Any
    ) -> None:
        sample(WEIGHTS[0] * h, t, s, x, U, u, p, work)
        for j in range(1, len(POINTS) - 1):
            interpolate(POINTS[j], h, x, xn, k, xd)
            sample(WEIGHTS[j] * h, t, s + POINTS[j] * h, xd, U, u, p, work)
        sample(WEIGHTS[-1] * h, t, s + h, xn, U, u, p, work)

    return quadrature
