"""Friction along a guide, of a valve's stem or a tappet in its bore: dry under the side load, and shear.

The guide of length L begins at the distance a from the place where the side force S acts, about which the
moment M turns. It presses with its two ends:

    N_2 = (M - S a)/L,    N_1 = S - N_2

The dry friction has the limit mu (|N_1| + |N_2|), and sticks (see `slider`). The oil in the clearance c is
sheared as in a bearing without load (Petroff 1883): F_v = pi mu d L v/c.
"""

import math
from dataclasses import dataclass

from .. import kinds
from ..compile.kernel import kernel
from ..core import roles
from ..core.component import Component, PowerBond
from ..core.integrator import FINE_TOLERANCE
from ..core.quantities import Vector, layouts
from .slider import Creep, RelaxationTime, Slip, StickingStiffness, find_slip, lost_power


@dataclass
class Parameters:
    """Defaults: the stem of a valve in its guide, mixed lubrication."""

    length: float = kinds.WIDTH("length L of the guide", 40e-3)
    diameter: float = kinds.DIAMETER("diameter d of stem or tappet", 6e-3)
    radial_clearance: float = kinds.CLEARANCE("radial clearance c in the guide", 20e-6)
    overhang: float = kinds.DISTANCE(
        "distance a of the guide from the side force; negative: the force acts inside", 20e-3
    )
    viscosity: float = kinds.VISCOSITY("viscosity of the oil", 0.01)
    friction_coefficient: float = kinds.FRICTION_COEFFICIENT("Coulomb's coefficient of friction mu", 0.1)
    sticking_stiffness: StickingStiffness = 1e6
    relaxation_time: RelaxationTime = 3e-5


@dataclass
class State:
    creep: Creep = 0.0


@dataclass
class Inputs:
    velocity: float = kinds.VELOCITY("velocity v in the guide")
    side_force: float = kinds.SIDE_FORCE("force S on the guide")
    side_moment: float = kinds.TORQUE("moment M about the place of that force", nominal=1.0)


@dataclass
class Outputs:
    friction_force: float = kinds.FRICTION("friction against the velocity")
    viscous_friction: float = kinds.FORCE("its share F_v of the oil", nominal=1.0)
    near_load: float = kinds.SIDE_FORCE("load N_1 on the guide's near end")
    far_load: float = kinds.SIDE_FORCE("load N_2 on its far end")
    sticking_margin: float = kinds.FRICTION("limit less what sticking would take; negative: it slides")
    power_loss: float = kinds.POWER("power lost to friction")


@kernel
def far_load(u: Inputs, p: Parameters) -> float:
    """N_2 = (M - S a)/L."""
    return (u.side_moment - u.side_force * p.overhang) / p.length


@kernel
def sliding_limit(u: Inputs, p: Parameters) -> float:
    """mu (|N_1| + |N_2|)."""
    far = far_load(u, p)
    return p.friction_coefficient * (abs(u.side_force - far) + abs(far))


@kernel
def shear_oil(p: Parameters) -> float:
    """pi mu d L/c."""
    return math.pi * p.viscosity * p.diameter * p.length / p.radial_clearance


@kernel
def find_creep(x: State, u: Inputs, p: Parameters) -> Slip:
    return find_slip(x.creep, u.velocity, sliding_limit(u, p), p.sticking_stiffness, p.relaxation_time)


@kernel
def lost_to_friction(slip: Slip, u: Inputs, p: Parameters) -> float:
    return lost_power(slip, p.sticking_stiffness, p.relaxation_time) + shear_oil(p) * u.velocity**2


@kernel
def derivative(t: float, x: State, u: Inputs, p: Parameters, dx: State) -> None:
    dx.creep = find_creep(x, u, p).rate


@kernel
def output(t: float, x: State, u: Inputs, p: Parameters, y: Outputs) -> None:
    slip = find_creep(x, u, p)
    y.viscous_friction = shear_oil(p) * u.velocity
    y.friction_force = slip.transmitted + y.viscous_friction
    y.far_load = far_load(u, p)
    y.near_load = u.side_force - y.far_load
    y.sticking_margin = sliding_limit(u, p) - abs(slip.sticking)
    y.power_loss = lost_to_friction(slip, u, p)


@kernel
def energy(t: float, x: State, u: Inputs, p: Parameters, e: Vector) -> None:
    e[0] = 0.5 * p.sticking_stiffness * x.creep**2
    e[1] = lost_to_friction(find_creep(x, u, p), u, p)
    e[2] = 0.0


def guide_friction() -> Component:
    """Dry friction of at most mu (|N_1| + |N_2|), and pi mu d L v/c."""
    moving = Inputs.__dataclass_fields__.keys()
    sides = ("side_force", "side_moment")
    return Component(
        tolerance=FINE_TOLERANCE,
        name="guide_friction",
        description="Friction of a valve's or tappet's guide",
        roles=(roles.Guide(), roles.Oiled()),
        **layouts(Parameters, State, Inputs, Outputs),
        derivative=derivative,
        output=output,
        energy=energy,
        feedthrough={
            "friction_force": tuple(moving),
            "viscous_friction": ("velocity",),
            "near_load": sides,
            "far_load": sides,
            "sticking_margin": tuple(moving),
            "power_loss": tuple(moving),
        },
        bonds=(PowerBond("friction_force", "velocity", +1),),
        event_indicators=("sticking_margin",),
    )
