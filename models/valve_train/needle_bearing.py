"""Needle bearing of a roller on its pin, or of a lever: friction by Palmgren.

Palmgren (1959), Ball and Roller Bearing Engineering, 3rd ed., with M in N mm, the mean diameter d_m in mm,
the oil's kinematic viscosity nu in mm2/s and the speed n in r/min:

    M = M_0 + f_1 F d_m,    M_0 = 1e-7 f_0 (nu n)^(2/3) d_m^3,    at least 160e-7 f_0 d_m^3

What does not depend on the speed, the load's share and the least M_0, is dry friction that sticks (`slider`).
"""

import math
from dataclasses import dataclass

from .. import kinds
from ..compile.kernel import kernel
from ..core import roles
from ..core.component import Component
from ..core.quantities import Quantity
from .pivot_friction import Inputs, PivotLaws, RelaxationTime, TwistStiffness, make_pivot

# nu n (mm2/s r/min) below which M_0 is constant: 2000^(2/3) = 159.
_SLOW = 160.0**1.5
_RPM = 30.0 / math.pi


@dataclass
class Parameters:
    """Defaults: caged needles in a roller of 18 mm, hot engine oil. f_0 and f_1 are in catalogues."""

    mean_diameter: float = kinds.DIAMETER("mean diameter d_m of the needles' circle", 10e-3)
    viscosity: float = kinds.VISCOSITY("viscosity of the oil", 0.01)
    density: float = Quantity("kg/m3", "density of the oil", nominal=1e3, positive=True).default(800.0)
    viscous_factor: float = kinds.NUMBER("bearing factor f_0", 5.0, nominal=5.0, minimum=0.0)
    load_factor: float = kinds.NUMBER("bearing factor f_1", 5e-4, nominal=1e-3, minimum=0.0)
    sticking_stiffness: TwistStiffness = 50.0
    relaxation_time: RelaxationTime = 3e-5


@kernel
def viscous_torque(rate: float, p: Parameters) -> float:
    """M_0 beyond its least value (N m), with the sign of the speed."""
    product = 1e6 * p.viscosity / p.density * abs(rate) * _RPM
    if product <= _SLOW:
        return 0.0
    torque = 1e-10 * p.viscous_factor * (product ** (2.0 / 3.0) - 160.0) * (1e3 * p.mean_diameter) ** 3
    return math.copysign(torque, rate)


@kernel
def sliding_torque(u: Inputs, p: Parameters) -> float:
    """f_1 F d_m and the least M_0 (N m)."""
    least = 160e-10 * p.viscous_factor * (1e3 * p.mean_diameter) ** 3
    return p.load_factor * abs(u.load) * p.mean_diameter + least


@kernel
def viscous_loss(rate: float, p: Parameters) -> float:
    return viscous_torque(rate, p) * rate


def needle_bearing() -> Component:
    """M = 1e-7 f_0 (nu n)^(2/3) d_m^3 + f_1 F d_m (N mm)."""
    return make_pivot(
        "needle_bearing",
        "Friction of a needle bearing of a roller or lever",
        Parameters,
        PivotLaws(sliding_torque, viscous_torque, viscous_loss),
        roles.Oiled(),
    )
