"""The lubricant under pressure: viscosity, density and shear thinning.

Laws of viscosity: Roelands, ln(eta/eta0) = (alpha p_r/z) [(1 + p/p_r)^z - 1]; Barus, alpha p; constant.
Laws of density: Dowson and Higginson, rho/rho0 = (0.59e9 + 1.34 p)/(0.59e9 + p); constant.
"""

import math
from typing import Any, NamedTuple

from ..compile.kernel import kernel

# The order is the number of the law in FMUs: append only.
VISCOSITY_LAWS = ("roelands", "barus", "constant")
DENSITY_LAWS = ("dowson_higginson", "constant")
ROELANDS, BARUS = 0.0, 1.0
DOWSON_HIGGINSON = 0.0

# Pressures of the Dowson-Higginson law (Pa) and its limit of density.
_DENSITY_PRESSURE = 0.59e9
_DENSEST = 1.34

# ln(eta/eta0) is cut here, far beyond any film that flows: exp must not overflow in a trial of Newton's.
_LARGEST_EXPONENT = 300.0


class Lubricant(NamedTuple):
    """Numbers of the laws; `viscosity_law` and `density_law` are positions in their lists.

    viscosity eta0 in Pa s, pressure_viscosity alpha in 1/Pa, roelands_pressure p_r in Pa, eyring_stress in Pa
    (0: Newtonian).
    """

    viscosity: float
    pressure_viscosity: float
    viscosity_law: float = ROELANDS
    density_law: float = DOWSON_HIGGINSON
    roelands_exponent: float = 0.68
    roelands_pressure: float = 1.96e8
    eyring_stress: float = 0.0


@kernel
def build_lubricant(p: Any, density_law: float) -> Lubricant:
    """The lubricant of a contact's parameters."""
    return Lubricant(
        p.viscosity, p.pressure_viscosity, p.viscosity_law, density_law, p.roelands_exponent,
        p.roelands_pressure, p.eyring_stress,
    )  # fmt: skip


@kernel
def log_viscosity(p: float, fluid: Lubricant) -> tuple[float, float]:
    """ln(eta/eta0) at the pressure p >= 0 (Pa), and its derivative (1/Pa)."""
    slope = fluid.pressure_viscosity
    if fluid.viscosity_law == ROELANDS:
        if p == 0.0:
            return 0.0, slope
        z, p_r = fluid.roelands_exponent, fluid.roelands_pressure
        more = 1.0 + p / p_r
        power = more**z
        return min(slope * p_r / z * (power - 1.0), _LARGEST_EXPONENT), slope * power / more
    if fluid.viscosity_law == BARUS:
        return min(slope * p, _LARGEST_EXPONENT), slope
    return 0.0, 0.0


@kernel
def viscosity_at(p: float, fluid: Lubricant) -> float:
    """eta(p) in Pa s."""
    return fluid.viscosity * math.exp(log_viscosity(p, fluid)[0])


@kernel
def density_ratio(p: float, fluid: Lubricant) -> float:
    """rho(p)/rho0."""
    if fluid.density_law == DOWSON_HIGGINSON:
        return (_DENSITY_PRESSURE + _DENSEST * p) / (_DENSITY_PRESSURE + p)
    return 1.0


@kernel
def density_slope(p: float, fluid: Lubricant) -> float:
    """d(rho/rho0)/dp (1/Pa)."""
    if fluid.density_law == DOWSON_HIGGINSON:
        return (_DENSEST - 1.0) * _DENSITY_PRESSURE / (_DENSITY_PRESSURE + p) ** 2
    return 0.0


@kernel
def enthalpy(p: float, fluid: Lubricant) -> float:
    """Integral of dp/(rho/rho0) from zero (J/m3): what it takes to bring oil into the pressure p (Pa)."""
    if fluid.density_law == DOWSON_HIGGINSON:
        share = 1.0 / _DENSEST
        return share * (p + _DENSITY_PRESSURE * (1.0 - share) * math.log1p(_DENSEST * p / _DENSITY_PRESSURE))
    return p


# Arguments beyond which sinh and cosh are exp/2, and exp does not overflow.
_LARGEST_SHEAR = 50.0


class Thinning(NamedTuple):
    """How much more an Eyring fluid flows under a pressure gradient than a Newtonian one (1 or more), and the
    derivatives of its logarithm by those of the gradient and the viscosity; by that of the film it is their
    difference."""

    factor: float
    by_gradient: float
    by_viscosity: float


@kernel
def thinning(
    viscosity: float, film: float, gradient: float, sliding: float, eyring_stress: float
) -> Thinning:
    """Conry, Wang and Cusano (1987): S = 3 (s cosh s - sinh s)/s^3 sqrt(1 + (t s/sinh s)^2),
    s = h p'/(2 tau_0), t = eta u_s/(tau_0 h), for viscosity eta (Pa s), film h (m), gradient p' (Pa/m),
    sliding velocity u_s (m/s).
    """
    s = min(abs(0.5 * film * gradient / eyring_stress), _LARGEST_SHEAR)
    t = viscosity * sliding / (eyring_stress * film)
    if s < 1e-3:
        square = t * t * (1.0 - s * s / 3.0)
        share = square / (1.0 + square)
        return Thinning((1.0 + 0.1 * s * s) * math.sqrt(1.0 + square), (0.2 - share / 3.0) * s * s, share)
    sinh, cosh = math.sinh(s), math.cosh(s)
    square = (t * s / sinh) ** 2
    share, rest = square / (1.0 + square), s * cosh - sinh
    by_gradient = s * s * sinh / rest - 3.0 + share * (1.0 - s * cosh / sinh)
    return Thinning(3.0 * rest / s**3 * math.sqrt(1.0 + square), by_gradient, share)
