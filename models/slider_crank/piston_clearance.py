"""Clearance between a valve's head and the piston's crown, which has a pocket for it.

The piston is below its top dead centre by

    x = sqrt((l + r)^2 - e^2) - r cos a - sqrt(l^2 - (r sin a + e)^2),   a = angle - asin(e/(l + r))

with the crank's radius r, the rod's length l and the offset e of the pin, so that x = 0 at the angle 0. The
valve's axis is inclined by i to the cylinder's. Along and across it the head is away from floor and wall of
its pocket by

    axial = recess + depth + deck cos i + x cos i - lift,   radial = play - |x sin i|
"""

import math
from dataclasses import dataclass

from .. import kinds
from ..compile.kernel import kernel
from ..core import roles
from ..core.component import Component
from ..core.quantities import Vector, layouts
from ..core.requirements import require
from ..plausible import CAM_LIFT
from .crank import CrankRadius, RodLength, crank_turns


@dataclass
class Parameters:
    """Defaults: the crank of `cylinder_gas` and a valve at 20 degrees."""

    crank_radius: CrankRadius = 0.043
    rod_length: RodLength = 0.143
    pin_offset: float = kinds.OFFSET("offset e of the piston's pin from the crank's axis")
    deck_height: float = kinds.DISPLACEMENT(
        "from the crown to the head's face at top dead centre, with the gasket", 1e-3, plausible=CAM_LIFT
    )
    valve_angle: float = kinds.LEVER_ANGLE(
        "angle i of the valve's axis to the cylinder's",
        math.radians(20.0),
        nominal=0.3,
        minimum=-1.5,
        maximum=1.5,
    )
    valve_recess: float = kinds.DISPLACEMENT(
        "from the head's face to the closed valve, along its axis; negative: it stands out", 1e-3
    )
    pocket_depth: float = kinds.DISPLACEMENT(
        "depth of the valve's pocket in the crown, along the valve's axis",
        3e-3,
        minimum=0.0,
        plausible=CAM_LIFT,
    )
    radial_play: float = kinds.DISPLACEMENT(
        "from the valve's head to the pocket's wall at top dead centre", 2e-3, minimum=0.0, plausible=CAM_LIFT
    )
    angle_ratio: float = kinds.NUMBER(
        "angle of the crank over the input `angle`: 2 where it is the cam's", 1.0, positive=True
    )
    top_angle: float = kinds.PHASE("the input `angle` at the top dead centre of gas exchange")


@dataclass
class State:
    pass


@dataclass
class Inputs:
    angle: float = kinds.ANGLE("angle of the crank or cam")
    valve_lift: float = kinds.DISPLACEMENT("lift of the valve")


@dataclass
class Outputs:
    clearance: float = kinds.DISPLACEMENT("clearance along the valve's axis; negative: they meet")
    radial_clearance: float = kinds.DISPLACEMENT("clearance to the pocket's wall, of a head in its pocket")
    piston_travel: float = kinds.PLACE("travel x of the piston from top dead centre", display_unit="mm")


@kernel
def piston_travel(crank: float, p: Parameters) -> float:
    """x, zero at the crank angle 0."""
    reach, e = p.rod_length + p.crank_radius, p.pin_offset
    a = crank - math.asin(e / reach)
    side = p.crank_radius * math.sin(a) + e
    return math.sqrt(reach**2 - e**2) - p.crank_radius * math.cos(a) - math.sqrt(p.rod_length**2 - side**2)


@kernel
def axial_clearance(travel: float, lift: float, p: Parameters) -> float:
    along = (p.deck_height + travel) * math.cos(p.valve_angle)
    return p.valve_recess + p.pocket_depth + along - lift


@kernel
def radial_clearance(travel: float, p: Parameters) -> float:
    return p.radial_play - abs(travel * math.sin(p.valve_angle))


@kernel
def derivative(t: float, x: State, u: Inputs, p: Parameters, dx: State) -> None:
    pass


@kernel
def output(t: float, x: State, u: Inputs, p: Parameters, y: Outputs) -> None:
    y.piston_travel = piston_travel(p.angle_ratio * (u.angle - p.top_angle), p)
    y.clearance = axial_clearance(y.piston_travel, u.valve_lift, p)
    y.radial_clearance = radial_clearance(y.piston_travel, p)


@kernel
def energy(t: float, x: State, u: Inputs, p: Parameters, e: Vector) -> None:
    e[:] = 0.0


@require("pin_offset = {0:g} m: must be less than rod_length - crank_radius = {1:g} m")
def rod_passes(p: Parameters, numbers: Vector) -> bool:
    numbers[0], numbers[1] = p.pin_offset, p.rod_length - p.crank_radius
    return p.crank_radius >= p.rod_length or abs(p.pin_offset) < p.rod_length - p.crank_radius


REQUIREMENTS = (crank_turns, rod_passes)


def piston_clearance() -> Component:
    """A kinematic observer: it acts on nothing."""
    return Component(
        name="piston_clearance",
        description="Clearance between a valve and the piston",
        roles=(roles.PistonClearance(),),
        **layouts(Parameters, State, Inputs, Outputs),
        derivative=derivative,
        output=output,
        energy=energy,
        feedthrough={
            "clearance": ("angle", "valve_lift"),
            "radial_clearance": ("angle",),
            "piston_travel": ("angle",),
        },
        requirements=REQUIREMENTS,
    )
