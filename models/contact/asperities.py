"""Contact of two rough surfaces: Greenwood and Tripp 1970, with its integrals to 1e-8.

A pair of equal summits of radius beta that overlap by w and lie r apart presses with Hertz's
4/3 E (beta/2)^1/2 (w - r^2/4 beta)^3/2, 1/E = compliance. Over all distances r, with eta summits per area
on each surface and Gaussian sums of heights with the standard deviation sigma, at a separation of the mean
planes of lambda sigma,

    p_a = (16 sqrt(2)/15) pi (eta beta sigma)^2 sqrt(sigma/beta) E F_5/2(lambda)
    A_c/A = pi^2 (eta beta sigma)^2 F_2(lambda)
    F_n(lambda) = (2 pi)^-1/2 int_lambda^inf (s - lambda)^n exp(-s^2/2) ds

(they print 8 sqrt(2)/15 with an E' of twice this E). As usual, summits and surface share one sigma and one
mean plane. A negative lambda, mean planes that would overlap, carries what thinner films leave.

A film's thickness is the mean gap of the rough surfaces, since flow conserves volume (Patir and Cheng 1978):
h/sigma = E[(lambda + s)+] = lambda Phi(lambda) + phi(lambda), which is lambda from 3 on (to 1.3e-4) and only
vanishes with lambda -> -inf, where the asperities carry any load.

`pressure_under` is the same law as a function of the film alone, with its derivative, for solvers that ask
for it at every node: F_5/2 by quintic Hermite interpolation of its logarithm.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.polynomial import chebyshev

from ..compile.kernel import kernel
from ..core.quantities import Vector

_ROOT_TWO_PI = math.sqrt(2.0 * math.pi)
# exp(-u^2/2) is 5e-27 here.
_TAIL = 11.0
# Chebyshev terms, in (|lambda| - _MIDDLE)/(|lambda| + _MIDDLE): chosen for a relative error below 1e-8.
_TERMS = 28
_MIDDLE = 2.0
# On the negative side F_5/2 ~ |lambda|^5/2 (1 + 15/(8 lambda^2)), as is (3/2 + lambda^2)^5/4.
_SHIFT = 1.5
# exp(-lambda^2/2) is zero here.
_NOTHING = 40.0
# Mean gap of mean planes that coincide, over sigma.
_GAP_AT_ZERO = 1.0 / _ROOT_TWO_PI
# From here on mean gap and separation are equal to rounding.
APART = 8.5
# Mean gaps over sigma below this count as this.
_LEAST_GAP = 1e-200
# Above this ratio of film to roughness asperities carry less than 1e-12 of the load of any contact.
THICK = 8.0
# The logarithm of F_5/2 is interpolated in w = ln(1 + ln(THICK sigma/h)), which is 0 at THICK and makes it
# bend little anywhere; so many intervals to a unit leave a relative error of 2e-8 in value and 1e-7 in slope.
_PER_UNIT = 16
_INTERVALS = int(math.log(1.0 + math.log(THICK / _LEAST_GAP)) * _PER_UNIT)
_LAST_GAP = THICK * math.exp(1.0 - math.exp(_INTERVALS / _PER_UNIT))


class Asperities(NamedTuple):
    """Rms of the sum of heights sigma (m), eta beta sigma and sigma/beta, both without unit."""

    roughness: float
    roughness_parameter: float
    asperity_slope: float


class AsperityPressure(NamedTuple):
    """p_a (Pa) and dp_a/dh (Pa/m), which is not positive."""

    pressure: float
    slope: float


def _quadrature(separation: Vector, order: float = 2.5) -> Vector:
    """F_order, times exp(lambda^2/2) where lambda > 0, with s - lambda = v^2 by the trapezoidal rule.

    The integrand 2 v^(2 order + 1) exp(-(v^2 + lambda)^2/2) is, for odd 2 order, even and entire, so that the
    rule converges faster than any power; 200 points leave rounding.
    """
    positive, negative = np.maximum(separation, 0.0)[:, None], np.maximum(-separation, 0.0)[:, None]
    low = np.sqrt(np.maximum(negative - _TAIL, 0.0))
    above = _TAIL**2 / (positive + np.hypot(positive, _TAIL))
    high = np.sqrt(np.where(positive > 0.0, above, negative + _TAIL))
    v = low + (high - low) * np.arange(1, 201)[None, :] / 200.0
    exponent = positive * v**2 + 0.5 * (v**2 - negative) ** 2
    power = v ** round(2.0 * order + 1.0)
    return np.asarray((2.0 * power * np.exp(-exponent)).sum(1) * (high - low)[:, 0] / 200.0 / _ROOT_TWO_PI)


def _coefficients() -> tuple[Vector, Vector]:
    """Chebyshev coefficients of exp(lambda^2/2) F (1 + lambda)^7/2 and F / (3/2 + lambda^2)^5/4."""
    y = chebyshev.chebpts1(_TERMS)
    size = _MIDDLE * (1.0 + y) / (1.0 - y)
    above = _quadrature(size) * (1.0 + size) ** 3.5
    below = _quadrature(-size) / (_SHIFT + size**2) ** 1.25
    fitted: Vector = np.asarray(chebyshev.chebfit(y, np.column_stack((above, below)), _TERMS - 1), float)
    return fitted[:, 0].copy(), fitted[:, 1].copy()


_ABOVE, _BELOW = _coefficients()


@kernel
def load_integral(separation: float) -> float:
    """F_5/2(lambda), to 1e-8 of itself for any lambda (from 38 on it underflows)."""
    if separation > _NOTHING:
        return 0.0
    size = abs(separation)
    y = (size - _MIDDLE) / (size + _MIDDLE)
    last = second = 0.0
    if separation >= 0.0:
        for i in range(_TERMS - 1, 0, -1):
            last, second = 2.0 * y * last - second + _ABOVE[i], last
        return (y * last - second + _ABOVE[0]) * math.exp(-0.5 * size * size) / (1.0 + size) ** 3.5
    for i in range(_TERMS - 1, 0, -1):
        last, second = 2.0 * y * last - second + _BELOW[i], last
    return (y * last - second + _BELOW[0]) * (_SHIFT + size * size) ** 1.25


@kernel
def _density(s: float) -> float:
    return math.exp(-0.5 * s * s) / _ROOT_TWO_PI


@kernel
def area_integral(separation: float) -> float:
    """F_2(lambda) = (1 + lambda^2) Phi(-lambda) - lambda phi(lambda)."""
    beyond = 0.5 * math.erfc(separation / math.sqrt(2.0))
    return max(0.0, (1.0 + separation * separation) * beyond - separation * _density(separation))


@kernel
def below(separation: float) -> float:
    """Phi(lambda), the share of the heights below lambda: what the mean gap grows by with it."""
    return 0.5 * math.erfc(-separation / math.sqrt(2.0))


@kernel
def gap_at(separation: float, share: float) -> float:
    """h/sigma = lambda Phi(lambda) + phi(lambda), given the share Phi(lambda)."""
    return max(0.0, separation * share + _density(separation))


@kernel
def mean_gap(separation: float) -> float:
    """h/sigma = lambda Phi(lambda) + phi(lambda), for any lambda."""
    return gap_at(separation, below(separation))


@kernel
def find_separation(gap: float) -> float:
    """The lambda whose mean gap is `gap` = h/sigma; gaps of _LEAST_GAP and less are taken as that.

    Newton's method on the logarithm of the mean gap, which is increasing and concave: monotone from the left,
    and from the first iterate of lambda = h/sigma - G(-lambda) soon there.
    """
    if gap >= APART:
        return gap
    target = max(gap, _LEAST_GAP)
    if target > 1.0:
        found = target - mean_gap(-target)
    elif target > _GAP_AT_ZERO:
        found = target - _GAP_AT_ZERO
    else:
        found = -math.sqrt(-2.0 * math.log(target / _GAP_AT_ZERO))
    for _ in range(40):
        here = mean_gap(found)
        slope = 0.5 * math.erfc(-found / math.sqrt(2.0)) / here
        change = math.log(target / here) / slope
        found += change
        # The next change would be of the order of the square of this one.
        if abs(change) < 1e-7:
            break
    return found


@kernel
def pressure_scale(surfaces: Asperities, compliance: float) -> float:
    """p_a/F_5/2 in Pa."""
    factor = 16.0 * math.sqrt(2.0) / 15.0 * math.pi * surfaces.roughness_parameter**2
    return factor * math.sqrt(surfaces.asperity_slope) / compliance


@kernel
def asperity_pressure(separation: float, surfaces: Asperities, compliance: float) -> float:
    """p_a in Pa at a separation of the mean planes of lambda = d/sigma."""
    return pressure_scale(surfaces, compliance) * load_integral(separation)


def _interpolation() -> Vector:
    """Coefficients of ln F_5/2 in w: a row for each interval, ascending powers of its unit coordinate.

    In numpy alone: kernels would be compiled for it whenever this module is imported.
    """
    below_thick = np.exp(np.arange(_INTERVALS + 1) / _PER_UNIT)  # 1 + ln(THICK sigma/h)
    gap = THICK * np.exp(1.0 - below_thick)
    low, high = np.full(len(gap), -_NOTHING), np.full(len(gap), THICK)
    for _ in range(60):
        separation = 0.5 * (low + high)
        density = np.exp(-0.5 * separation**2) / _ROOT_TWO_PI
        share = np.array([0.5 * math.erfc(-s / math.sqrt(2.0)) for s in separation])
        wide = separation * share + density > gap
        low, high = np.where(wide, low, separation), np.where(wide, separation, high)
    F, F_3, F_1 = (_quadrature(separation, order) for order in (2.5, 1.5, 0.5))
    # Derivatives by lambda, then by w with d lambda/dw = -e^w h/sigma/Phi(lambda).
    value = np.log(F) - 0.5 * np.maximum(separation, 0.0) ** 2
    first = -2.5 * F_3 / F
    second = 3.75 * F_1 / F - first**2
    speed = -below_thick * gap / share
    bend = speed * (1.0 - below_thick - speed * density / share)
    by_w = second * speed**2 + first * bend
    ends = np.column_stack((value, first * speed / _PER_UNIT, by_w / _PER_UNIT**2))
    start, end = ends[:-1], ends[1:]
    rise = end[:, 0] - start[:, 0] - start[:, 1] - 0.5 * start[:, 2]
    tilt = end[:, 1] - start[:, 1] - start[:, 2]
    curve = end[:, 2] - start[:, 2]
    return np.column_stack(
        (
            start[:, 0], start[:, 1], 0.5 * start[:, 2], 10.0 * rise - 4.0 * tilt + 0.5 * curve,
            -15.0 * rise + 7.0 * tilt - curve, 6.0 * rise - 3.0 * tilt + 0.5 * curve,
        )
    )  # fmt: skip


_LOGARITHM = _interpolation()


@kernel
def pressure_under(film: float, roughness: float, scale: float) -> AsperityPressure:
    """p_a and its derivative under a film (m) on a composite roughness sigma (m), to 2e-8 and 1e-7.

    `scale`: of `pressure_scale`. Twice continuously differentiable, and zero from films of THICK sigma on;
    films of none or less have the pressure of one of 1e-197 sigma.
    """
    gap = film / roughness
    if gap >= THICK:
        return AsperityPressure(0.0, 0.0)
    if math.isnan(gap):
        return AsperityPressure(gap, gap)
    gap = max(gap, _LAST_GAP)
    below_thick = 1.0 + math.log(THICK / gap)
    w = math.log(below_thick) * _PER_UNIT
    i = min(int(w), _INTERVALS - 1)
    r = w - i
    c = _LOGARITHM[i]
    value = c[0] + r * (c[1] + r * (c[2] + r * (c[3] + r * (c[4] + r * c[5]))))
    slope = c[1] + r * (2.0 * c[2] + r * (3.0 * c[3] + r * (4.0 * c[4] + r * 5.0 * c[5])))
    pressure = scale * math.exp(value)
    return AsperityPressure(pressure, -pressure * slope * _PER_UNIT / (below_thick * gap * roughness))


@kernel
def dry_separation(pressure: float, surfaces: Asperities, compliance: float) -> float:
    """The lambda, at most 8, where the asperities alone carry the pressure (Pa)."""
    target = pressure / pressure_scale(surfaces, compliance)
    # F_5/2(lambda) >= (-lambda)^5/2, since s^5/2 is convex.
    low, high = -(target**0.4), 8.0
    for _ in range(100):
        if high - low <= 1e-12 * (1.0 + abs(low)):
            break
        middle = 0.5 * (low + high)
        if load_integral(middle) > target:
            low = middle
        else:
            high = middle
    return high


@kernel
def real_area_share(separation: float, roughness_parameter: float) -> float:
    """A_c/A, at most 1."""
    return min(1.0, (math.pi * roughness_parameter) ** 2 * area_integral(separation))
