"""Asperities between a journal and its bush: the pressure of Greenwood and Tripp over the arc of contact.

With the radial clearance c the separation grows from d by c angle^2/2 along the arc, so that the integral of
F_5/2 over the angle is B(1/2, 7/2) sqrt(2 sigma/c) F_3(lambda), lambda = d/sigma, with the beta function
B(1/2, 7/2) = 5 pi/16.
"""

import math
from typing import NamedTuple

from ..compile.kernel import kernel
from .asperities import THICK, Asperities, area_integral, pressure_scale

_BETA = 5.0 * math.pi / 16.0


class Arc(NamedTuple):
    """Journal's radius, width of the bearing and radial clearance (m)."""

    radius: float
    width: float
    clearance: float


class AsperityForce(NamedTuple):
    """Force (N) and stored energy (J)."""

    load: float
    energy: float


@kernel
def press_arc(separation: float, arc: Arc, surfaces: Asperities, compliance: float) -> AsperityForce:
    """The force at a least separation of the mean planes of lambda = d/sigma, and its integral over -d.

    F_3 and F_4 follow from F_n = (n - 1) F_(n-2) - lambda F_(n-1).
    """
    if separation >= THICK:
        return AsperityForce(0.0, 0.0)
    density = math.exp(-0.5 * separation * separation) / math.sqrt(2.0 * math.pi)
    first = density - 0.5 * separation * math.erfc(separation / math.sqrt(2.0))
    second = area_integral(separation)
    third = max(0.0, 2.0 * first - separation * second)
    fourth = max(0.0, 3.0 * second - separation * third)
    angle = _BETA * math.sqrt(2.0 * surfaces.roughness / arc.clearance)
    scale = pressure_scale(surfaces, compliance) * arc.radius * arc.width * angle
    return AsperityForce(scale * third, 0.25 * scale * surfaces.roughness * fourth)
