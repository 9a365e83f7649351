"""Crank and rod: quantities and a requirement that slider-cranks and cylinder gas share."""

from typing import Annotated, Any

from .. import kinds
from ..core.quantities import Quantity, Vector
from ..core.requirements import require

CrankRadius = Annotated[float, kinds.LENGTH.of("crank radius")]
RodLength = Annotated[float, kinds.LENGTH.of("length of the connecting rod")]
CrankAngle = Annotated[float, kinds.ANGLE.of("crank angle, zero at top dead centre")]
CrankSpeed = Annotated[float, kinds.SPEED.of("crank speed")]
CrankAcceleration = Annotated[float, kinds.ANGULAR_ACCELERATION.of("angular acceleration of the crank")]
CrankImpulse = Annotated[
    float, Quantity("N.m.s", "sum of the angular impulses taken from the crank by impacts", nominal=0.1)
]
GasPressure = Annotated[
    float, Quantity("Pa", "gas pressure above that of the crankcase", nominal=1e5, display_unit="MPa")
]


@require("crank_radius = {0:g} m: must be less than rod_length = {1:g} m, or the crank cannot turn")
def crank_turns(p: Any, numbers: Vector) -> bool:
    numbers[0], numbers[1] = p.crank_radius, p.rod_length
    return p.crank_radius < p.rod_length
