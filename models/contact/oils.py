"""Lubricating oils: viscosity and pressure-viscosity coefficient at a temperature, from data of sheets.

Kinematic viscosity nu in mm2/s, temperature T in K (ASTM D341; Walther 1931):

    log10 log10(nu + 0.7) = A - B log10 T

through the oil's two points at 40 and 100 degC. Density (ASTM D1250-80, table 54D for lubricating oils), with
K = 0.6278 kg/(m3 K), t above 15 degC:

    rho = rho_15 exp[-a t (1 + 0.8 a t)],    a = K/rho_15

Pressure-viscosity coefficient (So and Klaus 1980, ASLE Trans. 23, 409), nu in mm2/s, rho in g/cm3, alpha in
10/GPa:

    alpha = 1.216 + 4.143 lg(nu)^3.0627 + 2.848e-4 B^5.1903 lg(nu)^1.5976 - 3.999 lg(nu)^3.0975 rho^0.1162

Roelands' exponent that goes with it, p_r = 196 MPa: z = alpha p_r/(ln eta0 + 9.67).
"""

import math
from dataclasses import dataclass
from typing import NamedTuple

ZERO_CELSIUS = 273.15
# K, between which an oil is evaluated; D341 leaves out wax below and decay above.
COLDEST, HOTTEST = ZERO_CELSIUS - 20.0, ZERO_CELSIUS + 200.0
# mm2/s. The constant 0.7 of D341 makes 0.3 % of error at 2 mm2/s and 2 % at 1 mm2/s, below which it grows.
THINNEST = 1.0
# mm2/s. Beyond, So and Klaus' alpha falls with the viscosity of thick oils, which no oil's does.
THICKEST_CORRELATED = 800.0
# B of ASTM D341: silicones lie below, and mineral oils of viscosity index 0 have 4.1 to 4.4.
SLOPES = (2.0, 4.5)
ROELANDS_PRESSURE = 1.96e8
_T_40, _T_100, _T_15 = ZERO_CELSIUS + 40.0, ZERO_CELSIUS + 100.0, ZERO_CELSIUS + 15.0
_EXPANSION = 0.6278


@dataclass(frozen=True)
class Oil:
    """Kinematic viscosities at 40 and 100 degC (m2/s), density at 15 degC (kg/m3).

    `pressure_viscosity` (1/Pa), if not 0, is measured: it replaces So and Klaus' correlation.
    """

    viscosity_40: float
    viscosity_100: float
    density_15: float
    pressure_viscosity: float = 0.0


class State(NamedTuple):
    """An oil at a temperature without pressure.

    viscosity eta0 in Pa s, pressure_viscosity alpha in 1/Pa, roelands_exponent z, temperature_viscosity
    beta = -d ln(eta0)/dT in 1/K.
    """

    viscosity: float
    pressure_viscosity: float
    roelands_exponent: float
    temperature_viscosity: float


def evaluate_oil(oil: Oil, temperature: float) -> State:
    """The oil at a temperature (K); ValueError outside the range of the equations."""
    if not COLDEST <= temperature <= HOTTEST:
        low, high = COLDEST - ZERO_CELSIUS, HOTTEST - ZERO_CELSIUS
        raise ValueError(f"must be {low:g} to {high:g} degC")
    kinematic = 1e6 * kinematic_viscosity(oil, temperature)
    if kinematic < THINNEST:
        raise ValueError(f"the oil has {kinematic:.2g} mm2/s, less than {THINNEST:g}: take a lower one")
    if not oil.pressure_viscosity and kinematic > THICKEST_CORRELATED:
        raise ValueError(
            f"the oil has {kinematic:.4g} mm2/s, and So and Klaus' pressure-viscosity coefficient holds to "
            f"{THICKEST_CORRELATED:g}: take a higher one, or an oil of your own with its pressure_viscosity"
        )
    viscosity = kinematic_viscosity(oil, temperature) * density(oil, temperature)
    alpha = oil.pressure_viscosity or pressure_viscosity(oil, temperature)
    exponent = alpha * ROELANDS_PRESSURE / (math.log(viscosity) + 9.67)
    return State(viscosity, alpha, exponent, temperature_viscosity(oil, temperature))


def walther_slope(oil: Oil) -> float:
    """B of ASTM D341."""
    return (_twice_log(oil.viscosity_40) - _twice_log(oil.viscosity_100)) / math.log10(_T_100 / _T_40)


def kinematic_viscosity(oil: Oil, temperature: float) -> float:
    """nu in m2/s (ASTM D341)."""
    exponent = _twice_log(oil.viscosity_40) - walther_slope(oil) * math.log10(temperature / _T_40)
    return 1e-6 * (10.0 ** (10.0**exponent) - 0.7)


def density(oil: Oil, temperature: float) -> float:
    """rho in kg/m3 (ASTM D1250-80, table 54D)."""
    expansion = _EXPANSION / oil.density_15 * (temperature - _T_15)
    return oil.density_15 * math.exp(-expansion * (1.0 + 0.8 * expansion))


def temperature_viscosity(oil: Oil, temperature: float) -> float:
    """beta = -d ln(nu rho)/dT in 1/K: B Z ln Z/(nu T), Z = nu + 0.7, and the share of the density."""
    kinematic = 1e6 * kinematic_viscosity(oil, temperature)
    more = kinematic + 0.7
    expansion = _EXPANSION / oil.density_15
    of_density = expansion * (1.0 + 1.6 * expansion * (temperature - _T_15))
    return walther_slope(oil) * more * math.log(more) / (kinematic * temperature) + of_density


def pressure_viscosity(oil: Oil, temperature: float) -> float:
    """alpha in 1/Pa (So and Klaus 1980)."""
    log = math.log10(1e6 * kinematic_viscosity(oil, temperature))
    found = (
        1.216
        + 4.143 * log**3.0627
        + 2.848e-4 * walther_slope(oil) ** 5.1903 * log**1.5976
        - 3.999 * log**3.0975 * (1e-3 * density(oil, temperature)) ** 0.1162
    )
    return 1e-8 * found


def _twice_log(viscosity: float) -> float:
    """log10 log10(nu + 0.7) of nu in m2/s."""
    return math.log10(math.log10(1e6 * viscosity + 0.7))
