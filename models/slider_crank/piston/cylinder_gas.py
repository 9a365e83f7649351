"""Gas pressure of a four-stroke cycle as a closed function of the crank angle.

While the valves are shut it lies between two polytropes, that of compression and that of expansion after
heat release at constant volume, by the share burned (Eriksson and Andersson 2002, SAE 2002-01-0371):

    p = (1 - w) p_c + w p_e,   p_c = p_i (V_bdc/V)^n_c,   p_e = p_c(0) R (V_c/V)^n_e,
    w = 1 - exp(-5 ((phi - phi_s)/duration)^3)            (Wiebe; Heywood 1988, (9.27), a = 5, m = 2)

with the volume of Heywood (2.6). Then blowdown to the exhaust's pressure, the exhaust stroke, and over the
overlap of the valves to the intake's; both changes are smooth (3 r^2 - 2 r^3), chosen here.

Or it goes through points, a measured cycle: the cubics that have p and dp/dtheta of both ends.
"""

import math
from dataclasses import dataclass
from typing import Any

from ... import kinds
from ...compile.kernel import kernel
from ...core import roles
from ...core.component import Component, check_sizes
from ...core.points import find_point, measure_segment
from ...core.quantities import Quantity, Vector, layouts
from ...core.requirements import require
from ...plausible import AREA
from ..crank import CrankAngle, CrankRadius, CrankSpeed, GasPressure, RodLength, crank_turns

TURN = 2.0 * math.pi
# Wiebe's constants, Heywood (9.27).
EFFICIENCY, FORM = 5.0, 3.0
_DEGREE = math.pi / 180.0
# The description of an FMU has three variables for each point.
LEAST_POINTS, MOST_POINTS = 4, 2000


@dataclass
class CylinderParameters:
    """What the pressure acts on."""

    crank_radius: CrankRadius = 0.043
    rod_length: RodLength = 0.143
    bore_area: float = Quantity("m2", "area of the bore", nominal=1e-2, positive=True).default(
        0.25 * math.pi * 0.086**2
    )
    crankcase_pressure: float = kinds.GAS_PRESSURE("pressure under the piston", 100e3, minimum=0.0)
    firing_angle: float = kinds.PHASE("crank angle of the firing dead centre")
    valve_area: Vector = Quantity(
        "m2", "area of a valve's head",
        nominal=1e-3, positive=True, display_unit="mm2", plausible=AREA, size="valves",
    ).per_element(0.25 * math.pi * 0.030**2)  # fmt: skip


@dataclass
class CylinderGasParameters(CylinderParameters):
    """Defaults chosen here: full load of a petrol engine at 2000 r/min (4.9 MPa at most)."""

    compression_ratio: float = kinds.NUMBER("largest over smallest volume", 10.0, nominal=10.0, minimum=1.1)
    intake_pressure: float = kinds.GAS_PRESSURE("pressure in the intake stroke", 95e3, positive=True)
    exhaust_pressure: float = kinds.GAS_PRESSURE("pressure in the exhaust stroke", 108e3, positive=True)
    compression_exponent: float = kinds.NUMBER("polytropic exponent n_c of the compression", 1.3, minimum=1.0)
    expansion_exponent: float = kinds.NUMBER("polytropic exponent n_e of the expansion", 1.27, minimum=1.0)
    pressure_ratio: float = kinds.NUMBER(
        "rise R by heat release at constant volume; 1: motored", 4.0, minimum=1.0
    )
    burn_start: float = kinds.ANGLE("begin of heat release before dead centre", 25.0 * _DEGREE, minimum=0.0)
    burn_duration: float = kinds.ANGLE("duration of the heat release", 60.0 * _DEGREE, positive=True)
    exhaust_opening: float = kinds.ANGLE(
        "begin of the blowdown after dead centre", 130.0 * _DEGREE, minimum=0.0
    )
    blowdown_duration: float = kinds.ANGLE("duration of the blowdown", 60.0 * _DEGREE, positive=True)
    overlap_duration: float = kinds.ANGLE(
        "change to intake pressure, about dead centre", 30.0 * _DEGREE, positive=True
    )


@dataclass
class GasTableParameters(CylinderParameters):
    """Absolute pressure at crank angles after the firing dead centre, which ascend within a cycle."""

    cycle_turns: float = kinds.NUMBER(
        "turns of the crank in a cycle: 2 of a four-stroke engine", 2.0, minimum=1.0
    )
    pressure_angle: Vector = kinds.ANGLE.each("crank angle of a point after dead centre", "pressure_points")
    point_pressure: Vector = Quantity(
        "Pa", "absolute pressure at a point", nominal=1e5, display_unit="kPa", size="pressure_points"
    ).per_element()
    pressure_slope: Vector = Quantity(
        "Pa", "dp/dtheta at a point, by radian", nominal=1e5, size="pressure_points"
    ).per_element()


@dataclass
class State:
    indicated_work: float = kinds.ENERGY(
        "work given to a piston without clearance and pin offset", nominal=100.0, accumulates=True
    )


@dataclass
class Inputs:
    crank_angle: CrankAngle = 0.0
    crank_speed: CrankSpeed = 0.0


@dataclass
class Outputs:
    gas_pressure: GasPressure = 0.0
    indicated_work: float = kinds.ENERGY(
        "work given to a piston without clearance and pin offset", nominal=100.0
    )
    valve_force: Vector = kinds.FORCE.each("force of the gas that closes a valve", "valves")


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
def pressure_through_points(theta: float, p: GasTableParameters) -> float:
    """Absolute pressure (Pa): Hermite's cubic between two points."""
    at, period = theta - p.firing_angle, p.cycle_turns * TURN
    i = find_point(at, p.pressure_angle, period)
    into, h = measure_segment(i, at, p.pressure_angle, period)
    j, r = (i + 1) % p.pressure_angle.size, into / h
    begin, end = p.point_pressure[i], p.point_pressure[j]
    rise, fall = h * p.pressure_slope[i], h * p.pressure_slope[j]
    return begin + r * (
        rise + r * (3.0 * (end - begin) - 2.0 * rise - fall + r * (2.0 * (begin - end) + rise + fall))
    )


def make_gas(pressure: Any) -> tuple[Any, Any]:
    """The kernels `derivative` and `output` of a gas of that pressure(theta, p)."""

    @kernel
    def derivative(t: float, x: State, u: Inputs, p: Any, dx: State) -> None:
        r, sine = p.crank_radius, math.sin(u.crank_angle)
        slope = r * math.cos(u.crank_angle) / math.sqrt(p.rod_length**2 - (r * sine) ** 2)
        gauge = pressure(u.crank_angle, p) - p.crankcase_pressure
        dx.indicated_work = gauge * p.bore_area * r * sine * (1.0 + slope) * u.crank_speed

    @kernel
    def output(t: float, x: State, u: Inputs, p: Any, y: Outputs) -> None:
        y.gas_pressure = pressure(u.crank_angle, p) - p.crankcase_pressure
        for i in range(p.valve_area.size):
            y.valve_force[i] = p.valve_area[i] * y.gas_pressure
        y.indicated_work = x.indicated_work

    return derivative, output


@kernel
def energy(t: float, x: State, u: Inputs, p: Any, e: Vector) -> None:
    """Nothing is stored here: the gas is a source of the piston that it pushes."""
    e[:] = 0.0


@require("burn_start = {0:g} rad: must be at most {1:g} rad, in compression")
def burns_in_compression(p: CylinderGasParameters, numbers: Vector) -> bool:
    numbers[0], numbers[1] = p.burn_start, 0.5 * TURN
    return p.burn_start <= 0.5 * TURN


@require(
    "exhaust_opening = {0:g} rad: must be at most {1:g} rad, so that the blowdown ends before the "
    "overlap begins"
)
def blows_down_before_overlap(p: CylinderGasParameters, numbers: Vector) -> bool:
    latest = TURN - 0.5 * p.overlap_duration - p.blowdown_duration
    numbers[0], numbers[1] = p.exhaust_opening, latest
    return p.exhaust_opening <= latest


@require(
    "pressure_angle[{0:.0f}] = {1:g} deg: must be less than the next one, {2:g} deg (of the last point: "
    "the first one a cycle later)"
)
def pressure_angles_ascend(p: GasTableParameters, numbers: Vector) -> bool:
    """Within a cycle."""
    n = p.pressure_angle.size
    for i in range(n):
        following = p.pressure_angle[i + 1] if i + 1 < n else p.pressure_angle[0] + p.cycle_turns * TURN
        if not p.pressure_angle[i] < following:
            numbers[0], numbers[1] = i + 1.0, math.degrees(p.pressure_angle[i])
            numbers[2] = math.degrees(following)
            return False
    return True


@require("point_pressure[{0:.0f}] = {1:g} Pa: must be > 0, an absolute pressure")
def pressures_are_absolute(p: GasTableParameters, numbers: Vector) -> bool:
    for i in range(p.point_pressure.size):
        if not p.point_pressure[i] > 0.0:
            numbers[0], numbers[1] = i + 1.0, p.point_pressure[i]
            return False
    return True


TABLE_REQUIREMENTS = (crank_turns, pressure_angles_ascend, pressures_are_absolute)
REQUIREMENTS = (crank_turns, burns_in_compression, blows_down_before_overlap)


def cylinder_gas(valves: int = 1, pressure_points: int = 0) -> Component:
    """Gas pressure of a four-stroke cycle, or through points of a cycle; its forces on the valves' heads."""
    check_sizes(valves=valves)
    if pressure_points and not LEAST_POINTS <= pressure_points <= MOST_POINTS:
        allowed = f"must be 0 (a cycle by a formula) or from {LEAST_POINTS} to {MOST_POINTS}"
        raise ValueError(f"pressure_points = {pressure_points}: {allowed}")
    sizes = {"valves": valves, "pressure_points": pressure_points}
    parameters = GasTableParameters if pressure_points else CylinderGasParameters
    derivative, output = make_gas(pressure_through_points if pressure_points else pressure)
    return Component(
        name="cylinder_gas",
        description="Gas pressure of a four-stroke cycle by the crank angle",
        roles=(roles.CylinderGas(),),
        **layouts(parameters, State, Inputs, Outputs, sizes),
        derivative=derivative,
        output=output,
        energy=energy,
        feedthrough=dict.fromkeys(
            ("gas_pressure", *(f"valve_force[{i + 1}]" for i in range(valves))), ("crank_angle",)
        ),
        structure=sizes,
        requirements=TABLE_REQUIREMENTS if pressure_points else REQUIREMENTS,
        resting=(),
    )
