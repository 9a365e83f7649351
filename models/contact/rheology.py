"""Shear stress of an oil at a shear rate, and its viscosity at a pressure and a rise of temperature.

Newton: tau = eta rate. Eyring (Johnson and Tevaarwerk 1977): tau = tau_0 asinh(eta rate/tau_0). A limiting
stress tau_L cuts it off, or the stress tau_f without limit approaches it as in Bair's and Winer's law (1979;
they take Newton's for tau_f): tau = tau_L [1 - exp(-tau_f/tau_L)].

Temperature (Roelands 1966, in the form of Houpert 1985), theta = (T - 138 K)/(T_0 - 138 K):

    ln(eta/eta(p, T_0)) = c (1 + p/p_r)^z (theta^-S - 1),  c = ln(eta0) + 9.67,  S = beta (T_0 - 138 K)/c

with beta = -d ln(eta0)/dT at T_0. Barus' and the constant law have no factor of the pressure in it.
"""

import math
from typing import NamedTuple

from ..compile.kernel import kernel
from .fluid import ROELANDS, Lubricant

# How a stress meets its limit. The order is the number of the law in FMUs: append only.
LIMITING_LAWS = ("cut", "gradual")
GRADUAL = 1.0

# Roelands' constants: -ln of the viscosity (Pa s) of all oils at -p_r, and the temperature (K) of the pole.
_ROELANDS_LOG, _POLE = 9.67, 138.0
# ln(eta0) + 9.67 of the thinnest fluid that the law is asked for; an oil of 1 mPa s has 2.8.
_LEAST_LOG = 0.1


class Thermal(NamedTuple):
    """The oil's temperature T_0 (K), where it has its viscosity eta0, and beta = -d ln(eta0)/dT (1/K)."""

    temperature: float
    temperature_viscosity: float


class Thinned(NamedTuple):
    """What a rise of temperature does to ln(eta) at no pressure, and its derivative by the rise (1/K)."""

    value: float
    slope: float


@kernel
def thin_by_heat(rise: float, viscosity: float, thermal: Thermal) -> Thinned:
    """c (theta^-S - 1) at T = T_0 + rise (K), above 138 K."""
    c = max(math.log(viscosity) + _ROELANDS_LOG, _LEAST_LOG)
    above = thermal.temperature - _POLE
    theta = 1.0 + rise / above
    left = theta ** (-thermal.temperature_viscosity * above / c)
    return Thinned(c * (left - 1.0), -thermal.temperature_viscosity * left / theta)


@kernel
def pressed_share(pressure: float, fluid: Lubricant) -> float:
    """(1 + p/p_r)^z, by which heat thins oil under the pressure p >= 0 (Pa) more than without."""
    if fluid.viscosity_law == ROELANDS and pressure > 0.0:
        return (1.0 + pressure / fluid.roelands_pressure) ** fluid.roelands_exponent
    return 1.0


@kernel
def fluid_stress(newtonian: float, eyring_stress: float) -> float:
    """Stress (Pa) of the fluid without limit, from eta rate >= 0 (Pa); Newton's without Eyring stress."""
    if eyring_stress > 0.0:
        return eyring_stress * math.asinh(newtonian / eyring_stress)
    return newtonian


@kernel
def limited_stress(stress: float, limit: float, limiting_law: float) -> float:
    """What a limit tau_L >= 0 (Pa) leaves of the stress >= 0 of the fluid."""
    if limiting_law == GRADUAL and limit > 0.0:
        return -limit * math.expm1(-stress / limit)
    return min(stress, limit)


@kernel
def stress_slope(newtonian: float, eyring_stress: float, limit: float, limiting_law: float) -> float:
    """d tau/d ln(eta) (Pa) of the limited stress of the fluid."""
    stress, slope = fluid_stress(newtonian, eyring_stress), newtonian
    if eyring_stress > 0.0:
        slope = newtonian / math.sqrt(1.0 + (newtonian / eyring_stress) ** 2)
    if limiting_law == GRADUAL and limit > 0.0:
        return slope * math.exp(-stress / limit)
    return slope if stress < limit else 0.0
