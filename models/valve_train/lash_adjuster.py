"""Hydraulic lash adjuster: an oil chamber between two bodies, with leak-down, check valve and air.

The plunger extends the adjuster by e over its length at the start; the bodies are apart by X = upper - lower
position. The oil is compressed by w = -A e - q, where q has left by the plunger's clearance (laminar,
concentric) and come back through the check valve. The pressure p over the supply's follows from w. The
plunger has no mass, and pushes the bodies without pulling them; the retainer holds it in its own body:

    N = A p + F_spring - k max(0, e - travel) >= 0,   e <= X,   N (X - e) = 0

A valve that floats lets the adjuster pump itself up in each cycle, until the retainer stops its plunger.
"""

import math
from dataclasses import dataclass
from typing import NamedTuple

from .. import kinds
from ..compile.kernel import kernel
from ..core import roles
from ..core.component import Component, PowerBond
from ..core.integrator import FINE_TOLERANCE
from ..core.quantities import Condition, Quantity, Vector, layouts
from ..plausible import CLEARANCE, GAS_PRESSURE, PART_LENGTH, VOLUME
from .shared import EndMotions

# Newton's steps for the pressure of oil with air end at this part of a volume; they converge from below.
STEPS, CLOSE = 60, 1e-15


@dataclass
class Parameters:
    """Defaults: an adjuster of 9 mm with a chamber of 600 mm3, without air."""

    plunger_diameter: float = kinds.DIAMETER("diameter of the plunger", 9e-3)
    chamber_volume: float = Quantity(
        "m3", "volume of the chamber", nominal=1e-6, positive=True, display_unit="mm3", plausible=VOLUME
    ).default(600e-9)
    bulk_modulus: float = Quantity(
        "Pa", "bulk modulus of the oil", nominal=1e9, positive=True, display_unit="MPa"
    ).default(1.5e9)
    air_content: float = kinds.NUMBER("volume of air in the oil at supply pressure", minimum=0.0, maximum=0.5)
    air_exponent: float = kinds.NUMBER(
        "polytropic exponent of the air", 1.4, minimum=1.0, maximum=2.0, only=Condition(("air_content",))
    )
    supply_pressure: float = Quantity(
        "Pa", "absolute pressure of the oil supply",
        nominal=1e5, positive=True, display_unit="MPa", plausible=GAS_PRESSURE,
    ).default(5e5)  # fmt: skip
    leak_clearance: float = kinds.FILM(
        "radial clearance of the plunger", 6e-6, minimum=0.0, plausible=CLEARANCE
    )
    leak_length: float = kinds.DISPLACEMENT(
        "length of the clearance", 5e-3, positive=True, plausible=PART_LENGTH
    )
    viscosity: float = kinds.VISCOSITY("viscosity of the oil", 0.01)
    valve_opening_pressure: float = Quantity(
        "Pa", "pressure below the supply's at which the check valve opens", minimum=0.0
    ).default(3e3)
    valve_conductance: float = Quantity(
        "m3/s.Pa", "flow through the check valve over pressure", nominal=1e-10, minimum=0.0
    ).default(1e-10)
    spring_force: float = kinds.FRICTION("force of the plunger's spring", 20.0, minimum=0.0)
    travel: float = kinds.DISPLACEMENT("extension at which the retainer stops the plunger", 2e-3, minimum=0.0)
    retainer_stiffness: float = kinds.STIFFNESS(
        "stiffness of the retainer", 1e7, nominal=1e7, minimum=0.0, display_unit="N/mm"
    )


@dataclass
class State:
    leaked_volume: float = Quantity(
        "m3", "oil that has left the chamber, less what came in", nominal=1e-9
    ).default()


@dataclass
class Outputs:
    force: float = kinds.FORCE("force that parts both bodies; 0: they are apart from the plunger")
    pressure: float = kinds.PRESSURE("pressure of the chamber over the supply's")
    extension: float = kinds.DEFLECTION("length to the plunger's end over that of the start")
    leak_flow: float = Quantity("m3/s", "flow out by the clearance", nominal=1e-7).default()
    valve_flow: float = Quantity("m3/s", "flow in through the check valve", nominal=1e-7).default()
    valve_excess: float = Quantity(
        "Pa", "pressure above that at which the check valve opens", nominal=1e6
    ).default()
    cavitates: float = kinds.SWITCH("the oil is torn, at no absolute pressure")


@kernel
def plunger_area(p: Parameters) -> float:
    return 0.25 * math.pi * p.plunger_diameter**2


class Plunger(NamedTuple):
    """Its extension, the pressure over the supply's, and the force on the bodies."""

    extension: float
    pressure: float
    force: float


@kernel
def compressed_volume(absolute: float, bulk_modulus: float, p: Parameters) -> float:
    """w = V0 [(1-a) (p - p_s)/beta + a (1 - (p_s/p)^(1/n))]."""
    oil = (1.0 - p.air_content) * (absolute - p.supply_pressure) / bulk_modulus
    air = p.air_content * (1.0 - (p.supply_pressure / absolute) ** (1.0 / p.air_exponent))
    return p.chamber_volume * (oil + air)


@kernel
def absolute_pressure(w: float, bulk_modulus: float, p: Parameters) -> float:
    """The pressure that compresses the oil by w; not below zero, where oil without air is torn.

    compressed_volume is concave, so that Newton's steps ascend to the root from any point below it. Where
    there is air, it begins with the air alone, which is stretched as much at a lower pressure.
    """
    stretched = w / p.chamber_volume
    if p.air_content == 0.0:
        return max(0.0, p.supply_pressure + stretched * bulk_modulus)
    alone = 1.0 - min(stretched, 0.0) / p.air_content
    absolute = p.supply_pressure * alone ** (-p.air_exponent)
    for _ in range(STEPS):
        ratio = (p.supply_pressure / absolute) ** (1.0 / p.air_exponent)
        slope = (1.0 - p.air_content) / bulk_modulus
        slope += p.air_content * ratio / (p.air_exponent * absolute)
        excess = stretched - compressed_volume(absolute, bulk_modulus, p) / p.chamber_volume
        absolute += excess / slope
        if abs(excess) <= CLOSE:
            break
    return absolute


@kernel
def leak_conductance(p: Parameters) -> float:
    """G = pi d h^3/(12 mu L)."""
    return math.pi * p.plunger_diameter * p.leak_clearance**3 / (12.0 * p.viscosity * p.leak_length)


@kernel
def overtravel(extension: float, p: Parameters) -> float:
    return max(0.0, extension - p.travel)


@kernel
def extend_freely(q: float, p: Parameters) -> float:
    """The extension at which spring, oil and retainer are in balance, N = 0; infinite: there is none.

    Within the travel p = -F/A. Beyond it k (e - travel) = A p + F, so that -A travel - q - A F/k compresses
    the oil and, by A^2 p/k, the retainer: the chamber is as one whose oil has a lower bulk modulus.
    """
    area, k = plunger_area(p), p.retainer_stiffness
    absolute = p.supply_pressure - p.spring_force / area
    if absolute > 0.0:
        extension = -(compressed_volume(absolute, p.bulk_modulus, p) + q) / area
        if k == 0.0 or extension <= p.travel:
            return extension
    if k == 0.0:
        return math.inf
    softer = 1.0 + p.bulk_modulus * area * area / ((1.0 - p.air_content) * p.chamber_volume * k)
    w = -area * (p.travel + p.spring_force / k) - q
    pressure = absolute_pressure(w, p.bulk_modulus / softer, p) - p.supply_pressure
    return p.travel + (area * pressure + p.spring_force) / k


@kernel
def push(extension: float, q: float, p: Parameters) -> Plunger:
    """The plunger at an extension, with the force that it takes; negative: a pull."""
    area = plunger_area(p)
    pressure = absolute_pressure(-area * extension - q, p.bulk_modulus, p) - p.supply_pressure
    force = area * pressure + p.spring_force - p.retainer_stiffness * overtravel(extension, p)
    return Plunger(extension, pressure, force)


@kernel
def plunger(x: State, u: EndMotions, p: Parameters) -> Plunger:
    """Between the bodies, or apart from them where these would have to pull."""
    apart = u.upper_position - u.lower_position
    held = push(apart, x.leaked_volume, p)
    if held.force < 0.0:
        free = push(min(apart, extend_freely(x.leaked_volume, p)), x.leaked_volume, p)
        return Plunger(free.extension, free.pressure, 0.0)
    return held


@kernel
def valve_flow(pressure: float, p: Parameters) -> float:
    return p.valve_conductance * max(0.0, -pressure - p.valve_opening_pressure)


@kernel
def derivative(t: float, x: State, u: EndMotions, p: Parameters, dx: State) -> None:
    pressure = plunger(x, u, p).pressure
    dx.leaked_volume = leak_conductance(p) * pressure - valve_flow(pressure, p)


@kernel
def output(t: float, x: State, u: EndMotions, p: Parameters, y: Outputs) -> None:
    extension, pressure, force = plunger(x, u, p)
    y.pressure = pressure
    y.force = force
    y.extension = extension
    y.leak_flow = leak_conductance(p) * pressure
    y.valve_flow = valve_flow(pressure, p)
    y.valve_excess = pressure + p.valve_opening_pressure
    y.cavitates = 1.0 if pressure + p.supply_pressure <= 0.0 else 0.0


@kernel
def energy(t: float, x: State, u: EndMotions, p: Parameters, e: Vector) -> None:
    """Stored: the integral of p dw, the plunger's spring, the retainer. Lost: in leak and check valve."""
    extension, pressure, _ = plunger(x, u, p)
    absolute, supply, a, n = pressure + p.supply_pressure, p.supply_pressure, p.air_content, p.air_exponent
    stored = (1.0 - a) * pressure * pressure / (2.0 * p.bulk_modulus)
    if absolute <= 0.0:
        # Torn: the hollow grows against the supply's pressure.
        w = -plunger_area(p) * extension - x.leaked_volume
        stored -= supply * (w / p.chamber_volume + supply / p.bulk_modulus)
    if a > 0.0:
        ratio = (supply / absolute) ** (1.0 / n)
        bent = math.log(absolute / supply) if n == 1.0 else (1.0 - absolute / supply * ratio) / (1.0 - n)
        stored += a * supply * (bent - (1.0 - ratio))
    retained = 0.5 * p.retainer_stiffness * overtravel(extension, p) ** 2
    e[0] = p.chamber_volume * stored - p.spring_force * extension + retained
    e[1] = pressure * (leak_conductance(p) * pressure - valve_flow(pressure, p))
    e[2] = 0.0


def lash_adjuster() -> Component:
    """N = A p + F_spring - retainer >= 0 on two bodies; dq/dt = G p - K max(0, -p - p_valve)."""
    places = ("lower_position", "upper_position")
    return Component(
        tolerance=FINE_TOLERANCE,
        name="lash_adjuster",
        description="Hydraulic lash adjuster: oil chamber with leak, check valve and air",
        roles=(roles.Adjuster(),),
        **layouts(Parameters, State, EndMotions, Outputs),
        derivative=derivative,
        output=output,
        energy=energy,
        feedthrough=dict.fromkeys(
            ("force", "pressure", "extension", "leak_flow", "valve_flow", "valve_excess", "cavitates"), places
        ),
        bonds=(PowerBond("force", "lower_velocity", +1), PowerBond("force", "upper_velocity", -1)),
        event_indicators=("valve_excess",),
    )
