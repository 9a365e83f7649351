"""One step of the method of Dormand and Prince, of order 5 with an error estimate of order 4."""

from typing import Any, NamedTuple

from ..compile.kernel import kernel


class Workspace(NamedTuple):
    """The data of one call of `advance`: time at its start, its arguments and its scratch vectors."""

    t: float
    x: Any  # state at the start of a step
    U: Any  # polynomials of the inputs
    p: Any  # parameters
    scale: Any  # nominal sizes of the states
    work: Any  # the whole scratch vector
    u: Any  # inputs at an instant
    k: Any  # seven derivatives, one after the other
    xt: Any  # state at an instant within a step
    xn: Any  # state at the end of a step


def make_scaled_error(n: int, tolerance: float) -> Any:
    """scaled_error(h, w): the largest error of a state in a step of length h, in units of its tolerance."""

    @kernel
    def scaled_error(h: float, w: Workspace) -> float:
        x, xn, k, scale = w.x, w.xn, w.k, w.scale
        worst = 0.0
        for i in range(n):
            error = h * (
                71.0 / 57600.0 * k[i]
                - 71.0 / 16695.0 * k[2 * n + i]
                + 71.0 / 1920.0 * k[3 * n + i]
                - 17253.0 / 339200.0 * k[4 * n + i]
                + 22.0 / 525.0 * k[5 * n + i]
                - 1.0 / 40.0 * k[6 * n + i]
            )
            ratio = abs(error) / (tolerance * (scale[i] + max(abs(x[i]), abs(xn[i]))))
            if ratio > worst or ratio != ratio:  # nan must reject the step, and stays
                worst = ratio
        return worst

    return scaled_error


def make_runge_kutta(derivative_along: Any, n: int, tolerance: float) -> Any:
    """runge_kutta(s, h, w) -> scaled error of the step from w.x at w.t + s; the new state is left in w.xn.

    The first of w.k must hold the derivative at the start; the last is the derivative at the end.
    """
    scaled_error = make_scaled_error(n, tolerance)

    @kernel
    def runge_kutta(s: float, h: float, w: Workspace) -> float:
        t, x, U, u, p, k, xt, xn = w.t, w.x, w.U, w.u, w.p, w.k, w.xt, w.xn
        k1, k2, k3, k4 = k[0:n], k[n : 2 * n], k[2 * n : 3 * n], k[3 * n : 4 * n]
        k5, k6, k7 = k[4 * n : 5 * n], k[5 * n : 6 * n], k[6 * n : 7 * n]
        for i in range(n):
            xt[i] = x[i] + h * (k1[i] / 5.0)
        derivative_along(t, s + h / 5.0, xt, U, u, p, k2)
        for i in range(n):
            xt[i] = x[i] + h * (3.0 / 40.0 * k1[i] + 9.0 / 40.0 * k2[i])
        derivative_along(t, s + 0.3 * h, xt, U, u, p, k3)
        for i in range(n):
            xt[i] = x[i] + h * (44.0 / 45.0 * k1[i] - 56.0 / 15.0 * k2[i] + 32.0 / 9.0 * k3[i])
        derivative_along(t, s + 0.8 * h, xt, U, u, p, k4)
        for i in range(n):
            xt[i] = x[i] + h * (
                19372.0 / 6561.0 * k1[i]
                - 25360.0 / 2187.0 * k2[i]
                + 64448.0 / 6561.0 * k3[i]
                - 212.0 / 729.0 * k4[i]
            )
        derivative_along(t, s + 8.0 / 9.0 * h, xt, U, u, p, k5)
        for i in range(n):
            xt[i] = x[i] + h * (
                9017.0 / 3168.0 * k1[i]
                - 355.0 / 33.0 * k2[i]
                + 46732.0 / 5247.0 * k3[i]
                + 49.0 / 176.0 * k4[i]
                - 5103.0 / 18656.0 * k5[i]
            )
        derivative_along(t, s + h, xt, U, u, p, k6)
        for i in range(n):
            xn[i] = x[i] + h * (
                35.0 / 384.0 * k1[i]
                + 500.0 / 1113.0 * k3[i]
                + 125.0 / 192.0 * k4[i]
                - 2187.0 / 6784.0 * k5[i]
                + 11.0 / 84.0 * k6[i]
            )
        derivative_along(t, s + h, xn, U, u, p, k7)
        return scaled_error(h, w)

    return runge_kutta


def make_interpolate(n: int) -> Any:
    """interpolate(f, h, w): the state at fraction f of the step from w.x to w.xn, left in w.xt.

    The fourth-order continuation of Hairer, Norsett and Wanner, Solving Ordinary Differential Equations I,
    II.6.
    """

    @kernel
    def interpolate(f: float, h: float, w: Workspace) -> None:
        x, xn, k, xt = w.x, w.xn, w.k, w.xt
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
            xt[i] = x[i] + f * (change + g * (start + f * (end + g * bend)))

    return interpolate
