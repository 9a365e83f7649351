"""Reynolds' equation of the line contact on finite volumes that move with the grid.

    d(rho h c)/dt + Q[i+1/2] - Q[i-1/2] = 0,    Q = (u - w) rho h - rho h^3/(12 eta) dp/dx

over the volume c of a node, with w the velocity of its faces; h = -approach + x^2/(2R) + deflection. Where
the film cavitates, p = 0 and the left side is positive (the gap opens faster than oil flows in).

rho h comes to a face by linear extrapolation from upstream (second order). The fluidity 1/eta of a face is
the logarithmic mean of its nodes', for which the flow of a fluid with eta ~ exp(alpha p) is exact: where
viscosity rises a thousandfold within a few nodes, any other mean sets a wrong film.
"""

import math
from typing import Any, NamedTuple

from ...compile.kernel import kernel, uncounted
from ..fluid import Lubricant, density_ratio, density_slope, log_viscosity, thinning

# Relative to which the difference of logarithms of fluidity is small: its mean is then a series.
_SMALL = 1e-3


class Flow(NamedTuple):
    """What drives the film at an instant: SI units, `sliding` for shear thinning only.

    `supply`: the layer of oil that enters (m) if cavities keep their oil; negative: they refill as if full.
    """

    velocity: float
    sliding: float
    radius: float
    supply: float = -1.0


class Nodes(NamedTuple):
    """Fields over the nodes and their derivatives, filled by `properties`: mass = rho h and its derivative
    by p; rho, that by h (0 in cavities that keep their oil); flow = rho h^3/12 with derivatives by p and h;
    ln(eta/eta0), its derivative, and eta0/eta.

    Not filled there: the filling, and `share`, a factor of the flow through the face behind the node, both 1
    but for cavities that keep their oil; that flow (m2/s), which `balance` fills. And what heat makes (see
    `shear`): factor of the pressure's flow, expansion, a factor of rho, and the drift of the mean velocity
    without pressure (m/s) with its derivatives by the node's own and by those on either side, from which
    `properties` has the drift."""

    mass: Any
    mass_p: Any
    rho: Any
    flow: Any
    flow_p: Any
    flow_h: Any
    log_eta: Any
    log_eta_p: Any
    fluidity: Any
    filled: Any
    share: Any
    through: Any
    factor: Any
    drift: Any
    expansion: Any
    drift_0: Any
    drift_p: Any
    drift_left: Any
    drift_right: Any


@kernel
def properties(p: Any, h: Any, fluid: Lubricant, f: Nodes) -> None:
    """Fill f from pressure and film."""
    n = p.shape[0]
    for i in range(n):
        rho = f.expansion[i] * density_ratio(p[i], fluid)
        slope = f.expansion[i] * density_slope(p[i], fluid)
        cube = f.factor[i] * (h[i] ** 3 / 12.0)
        beside = f.drift_left[i] * p[max(i - 1, 0)] + f.drift_right[i] * p[min(i + 1, n - 1)]
        f.drift[i] = f.drift_0[i] + f.drift_p[i] * p[i] + beside
        f.rho[i] = rho
        f.mass[i] = rho * h[i]
        f.mass_p[i] = slope * h[i]
        f.flow[i] = rho * cube
        f.flow_p[i] = slope * cube
        f.flow_h[i] = f.factor[i] * (rho * h[i] ** 2 / 4.0)
        f.log_eta[i], f.log_eta_p[i] = log_viscosity(p[i], fluid)
        f.fluidity[i] = math.exp(-f.log_eta[i])


@kernel
def mean_fluidity(difference: float, first: float, second: float) -> tuple[float, float, float]:
    """Logarithmic mean of first and second = first exp(-difference), and its derivatives by the logarithms
    of their inverses."""
    d = difference
    if abs(d) < _SMALL:
        mean = first * (1.0 - d / 2.0 + d * d / 6.0)
        by_second = first * (-0.5 + d / 3.0 - d * d / 8.0)
    else:
        mean = (first - second) / d
        by_second = (second - mean) / d
    return mean, -mean - by_second, by_second


@kernel
def cell(X: Any, i: int) -> float:
    """Width of node i's volume, in X."""
    return 0.5 * (X[i + 1] - X[i - 1])


class Carried(NamedTuple):
    """What surfaces carry through a face, velocity ((1 + reach) mass[near] - reach mass[far]) (m2/s, to the
    right positive): the node upstream of it and the one before that."""

    near: int
    far: int
    velocity: float
    reach: float


@uncounted
def carried(X: Any, i: int, scale_rate: float, drive: Flow, filled: Any, drift: float) -> Carried:
    """Through the face between nodes i and i + 1, with so much `drift` (m/s) besides. The extrapolation fades
    with the filling of both nodes, by which no layer becomes negative."""
    n = X.shape[0]
    face = 0.5 * (X[i] + X[i + 1])
    velocity = drive.velocity - scale_rate * face + drift
    near = i + 1 if velocity < 0.0 else i
    far = near + 1 if velocity < 0.0 else near - 1
    reach = 0.0
    if 0 <= far < n:
        reach = (face - X[near]) / (X[near] - X[far]) * (filled[near] * filled[far])
    else:
        far = near
    return Carried(near, far, velocity, reach)


@uncounted
def balance(
    X: Any, scale: float, scale_rate: float, p: Any, h: Any, f: Nodes, drive: Flow, fluid: Lubricant,
    old: Any, time_step: float, residual: Any, A: Any, B: Any,
) -> None:  # fmt: skip
    """The left side (m^2/s) with rate of mass (rho h c - old)/time_step, and its derivatives.

    A and B (5, n): by pressure and by film, element k of row i for node i + k - 2. time_step may be inf.
    Boundary rows stay zero.
    """
    n = X.shape[0]
    per_time = 1.0 / time_step
    for i in range(n):
        residual[i] = 0.0
        for k in range(5):
            A[k, i] = 0.0
            B[k, i] = 0.0
    for i in range(1, n - 1):
        c = scale * cell(X, i)
        residual[i] = (f.mass[i] * c - old[i]) * per_time
        A[2, i] = f.mass_p[i] * c * per_time
        B[2, i] = f.rho[i] * c * per_time
    for i in range(n - 1):
        drift = 0.5 * (f.drift[i] + f.drift[i + 1])
        near, far, velocity, reach = carried(X, i, scale_rate, drive, f.filled, drift)
        length = scale * (X[i + 1] - X[i])
        gradient = (p[i + 1] - p[i]) / length
        mean, by_first, by_second = mean_fluidity(
            f.log_eta[i + 1] - f.log_eta[i], f.fluidity[i], f.fluidity[i + 1]
        )
        shear, by_film = 1.0, 0.0
        if fluid.eyring_stress > 0.0:
            eta, film = fluid.viscosity / mean, 0.5 * (h[i] + h[i + 1])
            thin = thinning(eta, film, gradient, drive.sliding, fluid.eyring_stress)
            factor = thin.factor * (1.0 - thin.by_viscosity)
            mean, by_first, by_second = mean * thin.factor, by_first * factor, by_second * factor
            shear = 1.0 + thin.by_gradient
            by_film = 0.5 * (thin.by_gradient - thin.by_viscosity) / film
        mean, by_first, by_second = (
            mean / fluid.viscosity,
            by_first / fluid.viscosity,
            by_second / fluid.viscosity,
        )
        flow = 0.5 * (f.flow[i] + f.flow[i + 1])
        dragged = (1.0 + reach) * f.mass[near] - reach * f.mass[far]
        q = velocity * dragged - flow * mean * gradient
        f.through[i] = f.share[i] * q
        by_gradient = flow * mean * shear / length
        p_first = by_gradient - (0.5 * f.flow_p[i] * mean + flow * by_first * f.log_eta_p[i]) * gradient
        p_second = -by_gradient - (
            0.5 * f.flow_p[i + 1] * mean + flow * by_second * f.log_eta_p[i + 1]
        ) * gradient  # fmt: skip
        p_first += 0.5 * (f.drift_p[i] + f.drift_left[i + 1]) * dragged
        p_second += 0.5 * (f.drift_right[i] + f.drift_p[i + 1]) * dragged
        p_before, p_after = 0.5 * f.drift_left[i] * dragged, 0.5 * f.drift_right[i + 1] * dragged
        h_first = -(0.5 * f.flow_h[i] + flow * by_film) * mean * gradient
        h_second = -(0.5 * f.flow_h[i + 1] + flow * by_film) * mean * gradient
        for side in range(2):
            row = i + side
            if row == 0 or row == n - 1:
                continue
            sign = f.share[i] if side == 0 else -f.share[i]
            residual[row] += sign * q
            share = sign * velocity * (1.0 + reach)
            A[near - row + 2, row] += share * f.mass_p[near]
            B[near - row + 2, row] += share * f.rho[near]
            share = -sign * velocity * reach
            A[far - row + 2, row] += share * f.mass_p[far]
            B[far - row + 2, row] += share * f.rho[far]
            A[i - row + 1, row] += sign * p_before
            A[i - row + 2, row] += sign * p_first
            A[i - row + 3, row] += sign * p_second
            A[i - row + 4, row] += sign * p_after
            B[i - row + 2, row] += sign * h_first
            B[i - row + 3, row] += sign * h_second
