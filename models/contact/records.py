"""Parameters, inputs and outputs that the lubricated contacts have in common.

Numbers in parentheses refer to Kushwaha et al. 2000 (K).
"""

from __future__ import annotations

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


@dataclass
class SharedParameters:
    """Bodies, lubricant, surfaces and friction. Defaults: the set `kushwaha2000`."""

    load_is_given: Annotated[float, Quantity("1", "adherence form: the load is an input", boolean=True)] = 0.0
    length: Annotated[
        float,
        Quantity("m", "contact length L_c", nominal=1e-2, positive=True, maximum=LONGEST, display_unit="mm"),
    ] = 12e-3

    youngs_modulus_1: Annotated[float, _modulus("1 (cam)")] = 207e9
    poissons_ratio_1: Annotated[float, _poissons_ratio(1)] = 0.3
    youngs_modulus_2: Annotated[float, _modulus("2 (follower)")] = 207e9
    poissons_ratio_2: Annotated[float, _poissons_ratio(2)] = 0.3
    elastic_limit: Annotated[
        float, _yield_pressure("pressure at which the bodies yield: a warning", nominal=1e9)
    ] = ELASTIC_LIMIT
    viscosity: Annotated[
        float,
        Quantity(
            "Pa.s",
            "viscosity eta0 of the lubricant",
            nominal=1e-2,
            positive=True,
            maximum=THICKEST,
            plausible=VISCOSITY,
        ),
    ] = 0.036
    pressure_viscosity: Annotated[
        float,
        Quantity(
            "1/Pa",
            "pressure-viscosity coefficient alpha",
            nominal=1e-8,
            positive=True,
            plausible=PRESSURE_VISCOSITY,
        ),
    ] = 1.8e-8
    film_load_floor: Annotated[
        float, Quantity("N", "least load that the film is computed for", positive=True)
    ] = 1.0
    viscosity_law: Annotated[float, Quantity("1", "viscosity under pressure ", choices=VISCOSITY_LAWS)] = 0.0
    roelands_exponent: Annotated[
        float, Quantity("1", "exponent z of Roelands' law", positive=True, maximum=1.0)
    ] = 0.68
    roelands_pressure: Annotated[float, _yield_pressure("pressure p_r of Roelands' law", nominal=1e8)] = (
        1.96e8
    )
    eyring_stress: Annotated[float, _shear_stress("Eyring stress tau_0 of the film; 0: Newtonian")] = 0.0
    roughness: Annotated[
        float,
        Quantity(
            "m",
            "composite rms roughness; 0: smooth",
            nominal=1e-7,
            minimum=0.0,
            maximum=ROUGHEST,
            display_unit="um",
        ),
    ] = 0.2e-6
    roughness_parameter: Annotated[
        float, Quantity("1", "density x radius x rms of asperities", nominal=0.05, positive=True)
    ] = 0.05
    asperity_slope: Annotated[
        float, Quantity("1", "rms over radius of asperities", nominal=1e-3, positive=True)
    ] = 1e-3
    boundary_friction_coefficient: Annotated[
        float, _coefficient("friction coefficient mu_b of asperities")
    ] = 0.1
    boundary_shear_stress: Annotated[float, _shear_stress("shear stress tau_b of real contact besides")] = 0.0
    limiting_shear_stress: Annotated[float, _shear_stress("limiting shear stress tau_L0 at no pressure")] = (
        2e6
    )
    limiting_shear_coefficient: Annotated[float, _coefficient("growth gamma of the limit with pressure")] = (
        0.07
    )


FilmThickness = Annotated[
    float,
    Quantity(
        "m", "lubricant film thickness h", nominal=1e-6, positive=True, display_unit="um", plausible=FILM
    ),
]


@dataclass
class ContactInputs:
    approach: Annotated[
        float,
        Quantity(
            "m", "position of surface 1 towards surface 2, overlap positive", nominal=1e-3, display_unit="mm"
        ),
    ] = 0.0
    approach_rate: Annotated[float, Quantity("m/s", "velocity of surface 1 towards surface 2")] = 0.0
    retreat: Annotated[
        float,
        Quantity("m", "position of surface 2 away from surface 1", nominal=1e-3, display_unit="mm"),
    ] = 0.0
    retreat_rate: Annotated[float, Quantity("m/s", "velocity of surface 2 away from surface 1")] = 0.0
    applied_load: Annotated[float, Quantity("N", "load of the adherence form", nominal=500.0)] = 0.0
    entraining_velocity: Annotated[float, Quantity("m/s", "mean surface velocity u")] = 0.0
    sliding_velocity: Annotated[float, Quantity("m/s", "velocity of surface 1 over surface 2")] = 0.0
    radius_of_curvature: Annotated[
        float,
        Quantity(
            "m",
            "reduced radius R of the contact",
            nominal=1e-2,
            positive=True,
            display_unit="mm",
            plausible=CURVATURE,
        ),
    ] = 0.02


@dataclass
class SharedOutputs:
    load: Annotated[float, Quantity("N", "contact load W", nominal=500.0)] = 0.0
    film_thickness: Annotated[float, _micrometres("lubricant film thickness h")] = 0.0
    minimum_film_thickness: Annotated[
        float, _micrometres("smallest film thickness (of a formula: its film)")
    ] = 0.0
    squeeze_velocity: Annotated[float, Quantity("m/s", "dh/dt, positive when separating", nominal=1e-3)] = 0.0
    steady_film_thickness: Annotated[float, _micrometres("film thickness h_ss of the formula")] = 0.0
    deflection: Annotated[float, _micrometres("elastic approach of the bodies")] = 0.0
    half_width: Annotated[float, _micrometres("half width b of the contact", nominal=1e-4)] = 0.0
    maximum_pressure: Annotated[
        float, Quantity("Pa", "largest Hertz pressure p0", nominal=1e8, display_unit="MPa")
    ] = 0.0
    friction_force: Annotated[float, _force("friction of surface 2 on 1, against its sliding")] = 0.0
    viscous_friction: Annotated[float, _force("viscous share of the friction")] = 0.0
    boundary_friction: Annotated[float, _force("boundary share of the friction")] = 0.0
    asperity_load: Annotated[float, _force("load W_a on asperities")] = 0.0
    film_ratio: Annotated[float, Quantity("1", "film of the fluid's share over roughness; 0: smooth")] = 0.0


# The components that are lubricated contacts.
CONTACTS = ("ehl_contact", "ehl_line_contact")

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
