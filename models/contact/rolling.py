"""Rolling friction of a lubricated line contact: the shear that the pressure flow of the inlet needs.

Goksem and Hargreaves (1978), J. Lubrication Technology 100, 346, an inlet theory of Grubin's kind, as Zhou
and Hoeprich (1991), J. Tribology 113, 590 write it. Each surface is dragged against its motion by

    F_R = 4.318 phi (R L/alpha) (G U)^0.658 W^0.0126
    phi = D^(0.0106 L_T^0.317)/(1 + 0.411 L_T^0.707),    D = 11.81 G U/W^1.5,    L_T = beta eta0 u^2/k

with U, G and W of the film formulas. phi is the heat of shear in the inlet, 1 where it is left out. Both
surfaces lose F_R (u_1 + u_2) = 2 F_R u.
"""

import math

from ..compile.kernel import kernel
from .films.groups import Conditions, groups


@kernel
def rolling_friction(load: float, at: Conditions, thermal_loading: float) -> float:
    """F_R (N), with the sign of the entraining velocity u; 0 without load. Isothermal at L_T = 0."""
    if load <= 0.0 or at.velocity == 0.0:
        return 0.0
    g = groups(2.0 / at.compliance, load, at)
    inlet = g.material * g.speed
    force = 4.318 * at.radius * at.length / at.pressure_viscosity * inlet**0.658 * g.load**0.0126
    if thermal_loading > 0.0:
        force *= (11.81 * inlet / g.load**1.5) ** (0.0106 * thermal_loading**0.317)
        force /= 1.0 + 0.411 * thermal_loading**0.707
    return math.copysign(force, at.velocity)
