"""Parameters, inputs and outputs that the lubricated contacts have in common.

Numbers in parentheses refer to Kushwaha et al. 2000 (K).
"""

from dataclasses import dataclass
from typing import Annotated

from ..core.component import PowerBond
from ..core.quantities import Layout, Quantity
from ..plausible import (
    CURVATURE,
    FILM,
    PRESSURE_VISCOSITY,
    SHEAR_STRESS,
    VISCOSITY,
    YIELD_PRESSURE,
    YOUNGS_MODULUS,
)
from .fluid import VISCOSITY_LAWS
from .hertz import ELASTIC_LIMIT
from .oils import COLDEST, HOTTEST
from .rheology import LIMITING_LAWS

# Larger values are slips of the unit. A line contact (m) is no longer than the largest rollers. SAE J300 lets
# an engine's oil be no thicker (Pa.s) where it is cranked in the cold (grade 25W). Two coarsely turned
# surfaces of Ra 12.5 um (ISO 1302: N10) have 22 um rms together.
LONGEST, THICKEST, ROUGHEST = 1.0, 13.0, 22e-6


def _modulus(body: str) -> Quantity:
    meaning = f"Young's modulus of body {body}"
    return Quantity("Pa", meaning, nominal=1e11, positive=True, plausible=YOUNGS_MODULUS)


def _poissons_ratio(body: int) -> Quantity:
    return Quantity("1", f"Poisson's ratio of body {body}", minimum=0.0, maximum=0.5)


def _yield_pressure(meaning: str, nominal: float) -> Quantity:
    return Quantity("Pa", meaning, nominal=nominal, positive=True, plausible=YIELD_PRESSURE)


def _shear_stress(meaning: str) -> Quantity:
    return Quantity("Pa", meaning, nominal=1e6, minimum=0.0, plausible=SHEAR_STRESS)


def _coefficient(meaning: str) -> Quantity:
    return Quantity("1", meaning, nominal=0.1, minimum=0.0)


def _micrometres(meaning: str, nominal: float = 1e-6) -> Quantity:
    return Quantity("m", meaning, nominal=nominal, display_unit="um")


def _force(meaning: str) -> Quantity:
    return Quantity("N", meaning, nominal=10.0)


def _conductivity(body: str) -> Quantity:
    return Quantity("W/m.K", f"heat conductivity of body {body}", nominal=10.0, positive=True)


def _heat_capacity(body: str) -> Quantity:
    return Quantity("J/m3.K", f"heat capacity rho c of body {body}", nominal=1e6, positive=True)


@dataclass
class SharedParameters:
    """Bodies, lubricant, surfaces and friction. Defaults: the set `kushwaha2000`."""

    load_is_given: float = Quantity("1", "adherence form: the load is an input", boolean=True).default()
    length: float = Quantity(
        "m", "contact length L_c", nominal=1e-2, positive=True, maximum=LONGEST, display_unit="mm"
    ).default(12e-3)

    youngs_modulus_1: float = _modulus("1 (cam)").default(207e9)
    poissons_ratio_1: float = _poissons_ratio(1).default(0.3)
    youngs_modulus_2: float = _modulus("2 (follower)").default(207e9)
    poissons_ratio_2: float = _poissons_ratio(2).default(0.3)
    elastic_limit: float = _yield_pressure(
        "pressure at which the bodies yield: a warning", nominal=1e9
    ).default(ELASTIC_LIMIT)
    viscosity: float = Quantity(
        "Pa.s",
        "viscosity eta0 of the lubricant",
        nominal=1e-2,
        positive=True,
        maximum=THICKEST,
        plausible=VISCOSITY,
    ).default(0.036)
    pressure_viscosity: float = Quantity(
        "1/Pa",
        "pressure-viscosity coefficient alpha",
        nominal=1e-8,
        positive=True,
        plausible=PRESSURE_VISCOSITY,
    ).default(1.8e-8)
    film_load_floor: float = Quantity("N", "least load that the film is computed for", positive=True).default(
        1.0
    )
    viscosity_law: float = Quantity("1", "viscosity under pressure ", choices=VISCOSITY_LAWS).default()
    roelands_exponent: float = Quantity(
        "1", "exponent z of Roelands' law", positive=True, maximum=1.0
    ).default(0.68)
    roelands_pressure: float = _yield_pressure("pressure p_r of Roelands' law", nominal=1e8).default(1.96e8)
    eyring_stress: float = _shear_stress("Eyring stress tau_0 of the film; 0: Newtonian").default()
    roughness: float = Quantity(
        "m",
        "composite rms roughness; 0: smooth",
        nominal=1e-7,
        minimum=0.0,
        maximum=ROUGHEST,
        display_unit="um",
    ).default(0.2e-6)
    roughness_parameter: float = Quantity(
        "1", "density x radius x rms of asperities", nominal=0.05, positive=True
    ).default(0.05)
    asperity_slope: float = Quantity(
        "1", "rms over radius of asperities", nominal=1e-3, positive=True
    ).default(1e-3)
    boundary_friction_coefficient: float = _coefficient("friction coefficient mu_b of asperities").default(
        0.1
    )
    boundary_shear_stress: float = _shear_stress("shear stress tau_b of real contact besides").default()
    limiting_shear_stress: float = _shear_stress("limiting shear stress tau_L0 at no pressure").default(2e6)
    limiting_shear_coefficient: float = _coefficient("growth gamma of the limit with pressure").default(0.07)
    limiting_law: float = Quantity(
        "1", "how the film's stress meets the limit", choices=LIMITING_LAWS
    ).default()


TEMPERATURE_VISCOSITY = Quantity(
    "1/K", "fall beta of the viscosity with the temperature", nominal=0.03, minimum=0.0
)
OIL_CONDUCTIVITY = Quantity("W/m.K", "heat conductivity k of the oil", nominal=0.1, positive=True)


@dataclass
class HeatParameters:
    """The oil's temperature and how bodies conduct heat. Defaults: bearing steel, an engine's hot oil."""

    oil_temperature: float = Quantity(
        "K", "temperature T_0 of the oil, at which it has its viscosity", nominal=300.0, minimum=COLDEST,
        maximum=HOTTEST,
    ).default(363.15)  # fmt: skip
    conductivity_1: float = _conductivity("1 (cam)").default(46.0)
    heat_capacity_1: float = _heat_capacity("1 (cam)").default(3.6e6)
    conductivity_2: float = _conductivity("2 (follower)").default(46.0)
    heat_capacity_2: float = _heat_capacity("2 (follower)").default(3.6e6)


# m, about the size of an atom: a thinner film is none.
ATOM = 0.3e-9

FilmThickness = Annotated[
    float,
    Quantity(
        "m", "lubricant film thickness h", nominal=1e-6, positive=True, display_unit="um", plausible=FILM
    ),
]


@dataclass
class ContactInputs:
    approach: float = Quantity(
        "m", "position of surface 1 towards surface 2, overlap positive", nominal=1e-3, display_unit="mm"
    ).default()
    approach_rate: float = Quantity("m/s", "velocity of surface 1 towards surface 2").default()
    retreat: float = Quantity(
        "m", "position of surface 2 away from surface 1", nominal=1e-3, display_unit="mm"
    ).default()
    retreat_rate: float = Quantity("m/s", "velocity of surface 2 away from surface 1").default()
    applied_load: float = Quantity("N", "load of the adherence form", nominal=500.0).default()
    entraining_velocity: float = Quantity("m/s", "mean surface velocity u").default()
    sliding_velocity: float = Quantity("m/s", "velocity of surface 1 over surface 2").default()
    radius_of_curvature: float = Quantity(
        "m",
        "reduced radius R of the contact",
        nominal=1e-2,
        positive=True,
        display_unit="mm",
        plausible=CURVATURE,
    ).default(0.02)


@dataclass
class SharedOutputs:
    load: float = Quantity("N", "contact load W", nominal=500.0).default()
    film_thickness: float = _micrometres("lubricant film thickness h").default()
    minimum_film_thickness: float = _micrometres("smallest film thickness (of a formula: its film)").default()
    squeeze_velocity: float = Quantity("m/s", "dh/dt, positive when separating", nominal=1e-3).default()
    steady_film_thickness: float = _micrometres("film thickness h_ss of the formula").default()
    deflection: float = _micrometres("elastic approach of the bodies").default()
    half_width: float = _micrometres("half width b of the contact", nominal=1e-4).default()
    maximum_pressure: float = Quantity(
        "Pa", "largest Hertz pressure p0", nominal=1e8, display_unit="MPa"
    ).default()
    friction_force: float = _force("friction of surface 2 on 1, against its sliding").default()
    viscous_friction: float = _force("viscous share of the friction").default()
    boundary_friction: float = _force("boundary share of the friction").default()
    asperity_load: float = _force("load W_a on asperities").default()
    film_ratio: float = Quantity("1", "film of the fluid's share over roughness; 0: smooth").default()


BONDS = (PowerBond("load", "approach_rate", +1), PowerBond("load", "retreat_rate", -1))


def feedthrough_of_load(inputs: Layout, surfaces: tuple[str, ...]) -> dict[str, tuple[str, ...]]:
    """The inputs that outputs of a contact depend on at the same instant, the load on `surfaces`."""
    return {
        "load": surfaces,
        "deflection": ("approach", "retreat", "applied_load", "radius_of_curvature"),
        "half_width": surfaces,
        "maximum_pressure": surfaces,
        "friction_force": inputs.names,
        "viscous_friction": inputs.names,
        "asperity_load": surfaces,
        "film_ratio": surfaces,
        "boundary_friction": inputs.names,
        "separated": surfaces,
    }
