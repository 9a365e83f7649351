"""Gas pressure of a four-stroke cycle as a closed function of the crank angle.

While the valves are shut it lies between two polytropes, that of compression and that of expansion after
heat release at constant volume, by the share burned (Eriksson and Andersson 2002, SAE 2002-01-0371):

    p = (1 - w) p_c + w p_e,   p_c = p_i (V_bdc/V)^n_c,   p_e = p_c(0) R (V_c/V)^n_e,
    w = 1 - exp(-5 ((phi - phi_s)/duration)^3)            (Wiebe; Heywood 1988, (9.27), a = 5, m = 2)

with the volume of Heywood (2.6). Then blowdown to the exhaust's pressure, the exhaust stroke, and over the
overlap of the valves to the intake's; both changes are smooth (3 r^2 - 2 r^3), chosen here.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Annotated

from ...compile.kernel import kernel
from ...core.bonds import counts_energies
from ...core.component import Component, check_sizes
from ...core.quantities import Layout, Quantity, Vector, per_element
from ...core.requirements import Requirement
from ...plausible import ANGLE, AREA, GAS_PRESSURE, PART_LENGTH
from ..crank import crank_turns

TURN = 2.0 * math.pi
# Wiebe's constants, Heywood (9.27).
EFFICIENCY, FORM = 5.0, 3.0
_DEGREE = math.pi / 180.0


@dataclass
class CylinderGasParameters:
    """Defaults chosen here: full load of a petrol engine at 2000 r/min (4.9 MPa at most)."""

    crank_radius: Annotated[
        float,
        Quantity("m", "crank radius", nominal=0.1, positive=True, display_unit="mm", plausible=PART_LENGTH),
    ] = 0.043
    rod_length: Annotated[
        float,
        Quantity(
            "m",
            "length of the connecting rod",
            nominal=0.1,
            positive=True,
            display_unit="mm",
            plausible=PART_LENGTH,
        ),
    ] = 0.143
    bore_area: Annotated[float, Quantity("m2", "area of the bore", nominal=1e-2, positive=True)] = (
        0.25 * math.pi * 0.086**2
    )
    compression_ratio: Annotated[
        float, Quantity("1", "largest over smallest volume", nominal=10.0, minimum=1.1)
    ] = 10.0
    intake_pressure: Annotated[
        float,
        Quantity(
            "Pa",
            "pressure in the intake stroke",
            nominal=1e5,
            positive=True,
            display_unit="kPa",
            plausible=GAS_PRESSURE,
        ),
    ] = 95e3
    exhaust_pressure: Annotated[
        float,
        Quantity(
            "Pa",
            "pressure in the exhaust stroke",
            nominal=1e5,
            positive=True,
            display_unit="kPa",
            plausible=GAS_PRESSURE,
        ),
    ] = 108e3
    crankcase_pressure: Annotated[
        float,
        Quantity(
            "Pa",
            "pressure under the piston",
            nominal=1e5,
            minimum=0.0,
            display_unit="kPa",
            plausible=GAS_PRESSURE,
        ),
    ] = 100e3
    compression_exponent: Annotated[
        float, Quantity("1", "polytropic exponent n_c of the compression", minimum=1.0)
    ] = 1.3
    expansion_exponent: Annotated[
        float, Quantity("1", "polytropic exponent n_e of the expansion", minimum=1.0)
    ] = 1.27
    pressure_ratio: Annotated[
        float, Quantity("1", "rise R by heat release at constant volume; 1: motored", minimum=1.0)
    ] = 4.0
    firing_angle: Annotated[
        float, Quantity("rad", "crank angle of the firing dead centre", display_unit="deg", plausible=ANGLE)
    ] = 0.0
    burn_start: Annotated[
        float,
        Quantity("rad", "begin of heat release before dead centre", minimum=0.0, display_unit="deg"),
    ] = 25.0 * _DEGREE
    burn_duration: Annotated[
        float, Quantity("rad", "duration of the heat release", positive=True, display_unit="deg")
    ] = 60.0 * _DEGREE
    exhaust_opening: Annotated[
        float, Quantity("rad", "begin of the blowdown after dead centre", minimum=0.0, display_unit="deg")
    ] = 130.0 * _DEGREE
    blowdown_duration: Annotated[
        float, Quantity("rad", "duration of the blowdown", positive=True, display_unit="deg")
    ] = 60.0 * _DEGREE
    overlap_duration: Annotated[
        float,
        Quantity("rad", "change to intake pressure, about dead centre", positive=True, display_unit="deg"),
    ] = 30.0 * _DEGREE
    valve_area: Annotated[
        Vector,
        Quantity(
            "m2",
            "area of a valve's head",
            nominal=1e-3,
            positive=True,
            display_unit="mm2",
            plausible=AREA,
            size="valves",
        ),
    ] = per_element(0.25 * math.pi * 0.030**2)


@dataclass
class CylinderGasState:
    indicated_work: Annotated[
        float, Quantity("J", "work given to a piston without clearance and pin offset", nominal=100.0)
    ] = 0.0


@dataclass
class CylinderGasInputs:
    crank_angle: Annotated[
        float, Quantity("rad", "crank angle, zero at top dead centre", display_unit="deg")
    ] = 0.0
    crank_speed: Annotated[float, Quantity("rad/s", "crank speed", nominal=100.0, display_unit="rpm")] = 0.0


@dataclass
class CylinderGasOutputs:
    gas_pressure: Annotated[
        float, Quantity("Pa", "gas pressure above that of the crankcase", nominal=1e5, display_unit="MPa")
    ] = 0.0
    indicated_work: Annotated[
        float, Quantity("J", "work given to a piston without clearance and pin offset", nominal=100.0)
    ] = 0.0
    valve_force: Annotated[
        Vector, Quantity("N", "force of the gas that closes a valve", nominal=500.0, size="valves")
    ] = per_element()


@kernel
def relative_volume(theta: float, p: CylinderGasParameters) -> float:
    """V/V_c, Heywood (2.6)."""
    ratio = p.rod_length / p.crank_radius
    down = ratio + 1.0 - math.cos(theta) - math.sqrt(ratio**2 - math.sin(theta) ** 2)
    return 1.0 + 0.5 * (p.compression_ratio - 1.0) * down


@kernel
def smooth(r: float) -> float:
    inside = min(1.0, max(0.0, r))
    return inside * inside * (3.0 - 2.0 * inside)


@kernel
def burned_share(phi: float, p: CylinderGasParameters) -> float:
    """Wiebe's share burned."""
    r = max(0.0, (phi + p.burn_start) / p.burn_duration)
    return 1.0 - math.exp(-EFFICIENCY * r**FORM)


@kernel
def pressure(theta: float, p: CylinderGasParameters) -> float:
    """Absolute pressure (Pa)."""
    turned = theta - p.firing_angle + 0.5 * TURN
    phi = turned - 2.0 * TURN * math.floor(turned / (2.0 * TURN)) - 0.5 * TURN
    volume = relative_volume(phi, p)
    compressed = p.intake_pressure * (p.compression_ratio / volume) ** p.compression_exponent
    top = p.intake_pressure * p.compression_ratio**p.compression_exponent
    expanding = top * p.pressure_ratio * volume**-p.expansion_exponent
    shut = compressed + burned_share(phi, p) * (expanding - compressed)
    out = smooth((phi - p.exhaust_opening) / p.blowdown_duration)
    change = smooth((phi - TURN) / p.overlap_duration + 0.5)
    blown = shut + out * (p.exhaust_pressure - shut)
    return blown + change * (p.intake_pressure - blown)


@kernel
def gauge_pressure(u: CylinderGasInputs, p: CylinderGasParameters) -> float:
    return pressure(u.crank_angle, p) - p.crankcase_pressure


@kernel
def derivative(
    t: float, x: CylinderGasState, u: CylinderGasInputs, p: CylinderGasParameters, dx: CylinderGasState
) -> None:
    r, sine = p.crank_radius, math.sin(u.crank_angle)
    slope = r * math.cos(u.crank_angle) / math.sqrt(p.rod_length**2 - (r * sine) ** 2)
    dx.indicated_work = gauge_pressure(u, p) * p.bore_area * r * sine * (1.0 + slope) * u.crank_speed


@kernel
def output(
    t: float, x: CylinderGasState, u: CylinderGasInputs, p: CylinderGasParameters, y: CylinderGasOutputs
) -> None:
    y.gas_pressure = gauge_pressure(u, p)
    for i in range(p.valve_area.size):
        y.valve_force[i] = p.valve_area[i] * y.gas_pressure
    y.indicated_work = x.indicated_work


@kernel
def energy(t: float, x: CylinderGasState, u: CylinderGasInputs, p: CylinderGasParameters, e: Vector) -> None:
    """Nothing is stored here: the gas is a source of the piston that it pushes."""
    e[:] = 0.0


@kernel
def burns_in_compression(p: CylinderGasParameters, told: Vector) -> bool:
    told[0], told[1] = p.burn_start, 0.5 * TURN
    return p.burn_start <= 0.5 * TURN


@kernel
def blows_down_before_overlap(p: CylinderGasParameters, told: Vector) -> bool:
    latest = TURN - 0.5 * p.overlap_duration - p.blowdown_duration
    told[0], told[1] = p.exhaust_opening, latest
    return p.exhaust_opening <= latest


REQUIREMENTS = (
    Requirement(crank_turns, "crank_radius = {0:g} m: must be less than rod_length = {1:g} m"),
    Requirement(burns_in_compression, "burn_start = {0:g} rad: must be at most {1:g} rad, in compression"),
    Requirement(
        blows_down_before_overlap,
        "exhaust_opening = {0:g} rad: must be at most {1:g} rad, so that the blowdown ends before the "
        "overlap begins",
    ),
)


@counts_energies
def cylinder_gas(valves: int = 1) -> Component:
    """Gas pressure of a four-stroke cycle, and its forces on the heads of the valves."""
    check_sizes(valves=valves)
    sizes = {"valves": valves}
    return Component(
        name="cylinder_gas",
        description="Gas pressure of a four-stroke cycle by the crank angle",
        parameters=Layout(CylinderGasParameters, sizes),
        state=Layout(CylinderGasState),
        inputs=Layout(CylinderGasInputs),
        outputs=Layout(CylinderGasOutputs, sizes),
        derivative=derivative,
        output=output,
        energy=energy,
        feedthrough=dict.fromkeys(
            ("gas_pressure", *(f"valve_force[{i + 1}]" for i in range(valves))), ("crank_angle",)
        ),
        structure=sizes,
        requirements=REQUIREMENTS,
        resting=(),
    )
