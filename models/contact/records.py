"""Parameters, inputs and outputs that the lubricated contacts have in common.

Numbers in parentheses refer to Kushwaha et al. 2000 (K).
"""

from dataclasses import dataclass

from .. import kinds, plausible
from ..core.component import PowerBond
from ..core.quantities import Condition, Layout, Quantity
from .films import FILMS
from .fluid import VISCOSITY_LAWS
from .hertz import ELASTIC_LIMIT
from .oils import COLDEST, HOTTEST
from .rheology import LIMITING_LAWS

# Larger values are slips of the unit. A line contact (m) is no longer than the largest rollers. SAE J300 lets
# an engine's oil be no thicker (Pa.s) where it is cranked in the cold (grade 25W). Two coarsely turned
# surfaces of Ra 12.5 um (ISO 1302: N10) have 22 um rms together.
LONGEST, THICKEST, ROUGHEST = 1.0, 13.0, 22e-6

# The options of a contact that bring a film, Roelands' law and heat of the film into play.
IF_FILM = Condition(("film_model",), tuple(name for name in FILMS if name != "dry"))
IF_ROELANDS = Condition(("viscosity_law",), ("roelands",))
IF_HEATED = Condition(("film_heating",))

POISSONS_RATIO = Quantity("1", minimum=0.0, maximum=0.5)
YIELD_PRESSURE = Quantity("Pa", nominal=1e9, positive=True, plausible=plausible.YIELD_PRESSURE)
SHEAR_STRESS = Quantity("Pa", nominal=1e6, minimum=0.0, plausible=plausible.SHEAR_STRESS)
CONDUCTIVITY = Quantity("W/m.K", nominal=10.0, positive=True)
HEAT_CAPACITY = Quantity("J/m3.K", nominal=1e6, positive=True)
TEMPERATURE_RISE = Quantity("K", nominal=10.0)
CONTACT_PRESSURE = Quantity("Pa", nominal=1e8, display_unit="MPa")
POSITIVE = Quantity("1", positive=True)
FILM_STATE = Quantity("m", nominal=1e-6, positive=True, display_unit="um", plausible=plausible.FILM)


@dataclass
class SharedParameters:
    """Bodies, lubricant, surfaces and friction. Defaults: the set `kushwaha2000`."""

    load_is_given: float = kinds.SWITCH("adherence form: the load is an input")
    length: float = Quantity(
        "m", "contact length L_c", nominal=1e-2, positive=True, maximum=LONGEST, display_unit="mm"
    ).default(12e-3)

    youngs_modulus_1: float = kinds.YOUNGS_MODULUS("Young's modulus of body 1 (cam)", 207e9)
    poissons_ratio_1: float = POISSONS_RATIO("Poisson's ratio of body 1", 0.3)
    youngs_modulus_2: float = kinds.YOUNGS_MODULUS("Young's modulus of body 2 (follower)", 207e9)
    poissons_ratio_2: float = POISSONS_RATIO("Poisson's ratio of body 2", 0.3)
    elastic_limit: float = YIELD_PRESSURE("pressure at which the bodies yield: a warning", ELASTIC_LIMIT)
    viscosity: float = kinds.VISCOSITY("viscosity eta0 of the lubricant", 0.036, maximum=THICKEST)
    pressure_viscosity: float = Quantity(
        "1/Pa",
        "pressure-viscosity coefficient alpha",
        nominal=1e-8,
        positive=True,
        plausible=plausible.PRESSURE_VISCOSITY,
    ).default(1.8e-8)
    film_load_floor: float = Quantity(
        "N", "least load that the film is computed for", positive=True, only=IF_FILM
    ).default(1.0)
    viscosity_law: float = Quantity("1", "viscosity under pressure ", choices=VISCOSITY_LAWS).default()
    roelands_exponent: float = POSITIVE("exponent z of Roelands' law", 0.68, maximum=1.0, only=IF_ROELANDS)
    roelands_pressure: float = YIELD_PRESSURE(
        "pressure p_r of Roelands' law", 1.96e8, nominal=1e8, only=IF_ROELANDS
    )
    eyring_stress: float = SHEAR_STRESS("Eyring stress tau_0 of the film; 0: Newtonian", only=IF_FILM)
    roughness: float = Quantity(
        "m",
        "composite rms roughness; 0: smooth",
        nominal=1e-7,
        minimum=0.0,
        maximum=ROUGHEST,
        display_unit="um",
        only=IF_FILM,
    ).default(0.2e-6)
    roughness_parameter: float = POSITIVE(
        "density x radius x rms of asperities", 0.05, nominal=0.05, only=IF_FILM
    )
    asperity_slope: float = POSITIVE("rms over radius of asperities", 1e-3, nominal=1e-3, only=IF_FILM)
    boundary_friction_coefficient: float = kinds.FRICTION_COEFFICIENT(
        "friction coefficient mu_b of asperities", 0.1
    )
    boundary_shear_stress: float = SHEAR_STRESS("shear stress tau_b of real contact besides")
    limiting_shear_stress: float = SHEAR_STRESS(
        "limiting shear stress tau_L0 at no pressure", 2e6, only=IF_FILM
    )
    limiting_shear_coefficient: float = kinds.FRICTION_COEFFICIENT(
        "growth gamma of the limit with pressure", 0.07, only=IF_FILM
    )
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
        maximum=HOTTEST, only=IF_HEATED,
    ).default(363.15)  # fmt: skip
    conductivity_1: float = CONDUCTIVITY("heat conductivity of body 1 (cam)", 46.0, only=IF_HEATED)
    heat_capacity_1: float = HEAT_CAPACITY("heat capacity rho c of body 1 (cam)", 3.6e6, only=IF_HEATED)
    conductivity_2: float = CONDUCTIVITY("heat conductivity of body 2 (follower)", 46.0, only=IF_HEATED)
    heat_capacity_2: float = HEAT_CAPACITY("heat capacity rho c of body 2 (follower)", 3.6e6, only=IF_HEATED)


# m, about the size of an atom: a thinner film is none.
ATOM = 0.3e-9


@dataclass
class ContactInputs:
    approach: float = kinds.DISPLACEMENT("position of surface 1 towards surface 2, overlap positive")
    approach_rate: float = kinds.VELOCITY("velocity of surface 1 towards surface 2")
    retreat: float = kinds.DISPLACEMENT("position of surface 2 away from surface 1")
    retreat_rate: float = kinds.VELOCITY("velocity of surface 2 away from surface 1")
    applied_load: float = kinds.FORCE("load of the adherence form")
    entraining_velocity: float = kinds.VELOCITY("mean surface velocity u")
    sliding_velocity: float = kinds.VELOCITY("velocity of surface 1 over surface 2")
    radius_of_curvature: float = kinds.ARC("reduced radius R of the contact", 0.02)


@dataclass
class SharedOutputs:
    load: float = kinds.FORCE("contact load W")
    film_thickness: float = kinds.FILM("lubricant film thickness h")
    minimum_film_thickness: float = kinds.FILM("smallest film thickness (of a formula: its film)")
    squeeze_velocity: float = kinds.VELOCITY("dh/dt, positive when separating", nominal=1e-3)
    steady_film_thickness: float = kinds.FILM("film thickness h_ss of the formula")
    deflection: float = kinds.FILM("elastic approach of the bodies")
    half_width: float = kinds.FILM("half width b of the contact", nominal=1e-4)
    maximum_pressure: float = CONTACT_PRESSURE("largest Hertz pressure p0")
    friction_force: float = kinds.FRICTION("friction of surface 2 on 1, against its sliding")
    viscous_friction: float = kinds.FRICTION("viscous share of the friction")
    boundary_friction: float = kinds.FRICTION("boundary share of the friction")
    asperity_load: float = kinds.FRICTION("load W_a on asperities")
    film_ratio: float = kinds.NUMBER("film of the fluid's share over roughness; 0: smooth")


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
