"""Crank and rod: quantities and a requirement that slider-cranks and cylinder gas share."""

from typing import Annotated, Any

from ..compile.kernel import kernel
from ..core.quantities import Quantity, Vector
from ..plausible import PART_LENGTH

CrankRadius = Annotated[
    float, Quantity("m", "crank radius", nominal=0.1, positive=True, display_unit="mm", plausible=PART_LENGTH)
]
RodLength = Annotated[
    float,
    Quantity(
        "m", "length of the connecting rod", nominal=0.1, positive=True, display_unit="mm",
        plausible=PART_LENGTH,
    ),
]  # fmt: skip
CrankAngle = Annotated[float, Quantity("rad", "crank angle, zero at top dead centre", display_unit="deg")]
CrankSpeed = Annotated[float, Quantity("rad/s", "crank speed", nominal=100.0, display_unit="rpm")]
CrankAcceleration = Annotated[float, Quantity("rad/s2", "angular acceleration of the crank", nominal=100.0)]
CrankImpulse = Annotated[
    float, Quantity("N.m.s", "sum of the angular impulses taken from the crank by impacts", nominal=0.1)
]
GasPressure = Annotated[
    float, Quantity("Pa", "gas pressure above that of the crankcase", nominal=1e5, display_unit="MPa")
]


@kernel
def crank_turns(p: Any, numbers: Vector) -> bool:
    """The crank is shorter than the rod; reports both."""
    numbers[0], numbers[1] = p.crank_radius, p.rod_length
    return p.crank_radius < p.rod_length
