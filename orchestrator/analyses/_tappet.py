"""The cam contact of the set `kushwaha2000` as a finite line, and the parameters that its analyses share."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from models.contact.analysis.finite_line.contact import FiniteLine, Running
from models.contact.analysis.finite_line.grid import Resolution
from models.contact.analysis.finite_line.profiles import (
    Chamfered,
    Crowned,
    Logarithmic,
    Profile,
    Straight,
    johns_gohar,
)
from models.contact.ehl_contact import ContactParameters
from models.contact.fluid import Lubricant
from models.contact.hertz import ELASTIC_LIMIT, elastic_compliance
from models.core.quantities import Layout
from models.valve_train.camshaft import CamshaftParameters
from models.valve_train.rigid import contact_conditions
from models.valve_train.shaft_element import static_slope
from models.valve_train.valve_spring import ValveSpringParameters

from .protocol import Parameter

PROFILES = ("straight", "chamfered", "crowned", "logarithmic")
CAM = Layout(CamshaftParameters).defaults()
CONTACT, SPRING = ContactParameters(), ValveSpringParameters()
COMPLIANCE = elastic_compliance(
    CONTACT.youngs_modulus_1, CONTACT.poissons_ratio_1, CONTACT.youngs_modulus_2, CONTACT.poissons_ratio_2
)

PARAMETERS = {
    "speed": Parameter(1000.0 * math.pi / 30.0, "rad/s", "speed of the cam", positive=True),
    "profile": Parameter("straight", "1", "axial profile", choices=PROFILES),
    "alignment": Parameter(
        0.0, "1", "share of the shaft's static slope that misaligns the contact", minimum=0.0, maximum=1.0
    ),
    "shaft_length": Parameter(CAM.shaft_length, "m", "length of the shaft element", positive=True),
    "crown_radius": Parameter(4.0, "m", "radius of the crowned profile", positive=True),
    "chamfer_width": Parameter(0.5e-3, "m", "width of the chamfers", positive=True),
    "chamfer_slope": Parameter(0.005, "1", "slope of the chamfers", positive=True),
    "dub_off": Parameter(
        0.0, "m", "drop of the logarithmic profile at the ends; 0: by Johns and Gohar", minimum=0.0
    ),
    "nodes_per_inlet": Parameter(
        6.0, "1", "nodes along x in the inlet, where that is finer; 2 are needed", positive=True
    ),
    "end_cell": Parameter(0.1, "1", "cells along the length at the ends, in half widths", positive=True),
}


ALIGNMENTS = ("aligned", "misaligned")
# Warning about an instant without a film.
DRY = "entrainment all but ends: no film, taken as dry; the pressure of a sharp end there is the grid's"


def read_resolution(values: Mapping[str, Any]) -> Resolution:
    return Resolution(
        values["nodes_per_half_width"], values["end_cell"], nodes_per_inlet=values["nodes_per_inlet"]
    )


def describe_yielding(pressure: float) -> str:
    """A warning about a pressure (Pa) above the elastic limit of hardened bearing steel; "" below it."""
    if pressure <= ELASTIC_LIMIT:
        return ""
    return (
        f"the pressure reaches {1e-9 * pressure:.3g} GPa, above the elastic limit of "
        f"{1e-9 * ELASTIC_LIMIT:.3g} GPa: the bodies yield, which is left out; lower the load or the "
        "misalignment, or take another profile"
    )


def compute_running(angle: float, values: Mapping[str, Any], share: float) -> Running:
    """Load, velocity, radius at a cam angle (rad), with a rigid shaft and a massless spring; the shaft's
    static slope under that load times `share`."""
    at = contact_conditions(angle, values["speed"], CAM, SPRING)
    camshaft = Layout(CamshaftParameters)
    shaft = camshaft.view(camshaft.vector({"shaft_length": values["shaft_length"]}))
    slope = share * abs(static_slope(at.load, shaft))
    return Running(at.load, at.entraining_velocity, at.radius_of_curvature, slope)


def build_finite_line(name: str, values: Mapping[str, Any], design: Running) -> FiniteLine:
    """The contact with that profile; a logarithmic one as the load of `design` asks for."""
    oil = Lubricant(CONTACT.viscosity, CONTACT.pressure_viscosity)
    return FiniteLine(CONTACT.length, COMPLIANCE, oil, _build_profile(name, values, design))


def _build_profile(name: str, values: Mapping[str, Any], design: Running) -> Profile:
    if name == "chamfered":
        return Chamfered(values["chamfer_width"], values["chamfer_slope"])
    if name == "crowned":
        return Crowned(values["crown_radius"])
    if name == "logarithmic":
        profile = johns_gohar(design.load, design.radius, CONTACT.length, COMPLIANCE)
        return profile if values["dub_off"] <= 0.0 else Logarithmic(profile.amplitude, values["dub_off"])
    return Straight()
