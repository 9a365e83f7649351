"""Friction of a lever's pivot: Coulomb friction that sticks (see `slider`), and viscous friction.

The dry torque T has the limit T_c = mu r |F| + T_0, which varies with the load F; the whole one is
T + c omega.
"""

from dataclasses import dataclass
from typing import Annotated, Any, NamedTuple

from .. import kinds
from ..compile.kernel import kernel
from ..core import roles
from ..core.component import Component, PowerBond
from ..core.integrator import FINE_TOLERANCE
from ..core.quantities import Quantity, Vector, layouts
from ..core.roles import Role
from .slider import Slip, find_slip, lost_power

TwistStiffness = Annotated[
    float, Quantity("N.m/rad", "stiffness k of the sticking surfaces", nominal=1e3, positive=True)
]
RelaxationTime = Annotated[
    float, kinds.TIME.of("damping of their twist over the stiffness, tau", nominal=1e-5, positive=True)
]


@dataclass
class Parameters:
    """Defaults: a pin of 16 mm in mixed lubrication, which twists by 1.3 um under 1000 N before it slides."""

    friction_coefficient: float = kinds.FRICTION_COEFFICIENT("Coulomb's coefficient of friction mu", 0.1)
    radius: float = kinds.WIDTH("radius of the pivot's pin or ball", 8e-3)
    preload_torque: float = kinds.FRICTION_TORQUE("limit T_0 of the dry friction without load", minimum=0.0)
    viscous_coefficient: float = kinds.TURNING_DAMPING("viscous friction c over speed", nominal=1e-3)
    sticking_stiffness: TwistStiffness = 5e3
    relaxation_time: RelaxationTime = 3e-5


@dataclass
class State:
    twist: float = kinds.TILT("elastic twist z of the sticking surfaces", nominal=1e-4)


@dataclass
class Inputs:
    rotation_rate: float = kinds.ROTATION_RATE("speed omega of the lever")
    load: float = kinds.FORCE("force F on the pivot")


@dataclass
class Outputs:
    friction_torque: float = kinds.FRICTION_TORQUE("torque T against the lever's rotation")
    sliding_torque: float = kinds.FRICTION_TORQUE("limit T_c of the dry friction under this load")
    sticking_margin: float = kinds.FRICTION_TORQUE("limit less what sticking would take; negative: it slides")
    sliding_rate: float = kinds.ROTATION_RATE("part of the speed by which the surfaces slide")
    power_loss: float = kinds.POWER("power lost to friction", nominal=1.0)


@kernel
def sliding_torque(u: Inputs, p: Parameters) -> float:
    """T_c = mu r |F| + T_0."""
    return p.friction_coefficient * p.radius * abs(u.load) + p.preload_torque


@kernel
def viscous_torque(rate: float, p: Parameters) -> float:
    """c omega."""
    return p.viscous_coefficient * rate


@kernel
def viscous_loss(rate: float, p: Parameters) -> float:
    """c omega^2."""
    return p.viscous_coefficient * rate**2


class PivotLaws(NamedTuple):
    """Kernels of a pivot's friction: the limit of the dry torque (inputs, parameters); the viscous torque and
    the power that it takes (speed, parameters)."""

    sliding_torque: Any
    viscous_torque: Any
    viscous_loss: Any


def make_pivot(name: str, description: str, parameters: type, laws: PivotLaws, *more: Role) -> Component:
    """A joint whose dry friction sticks up to a limit, beside a viscous one; it has the roles `more` too."""
    sliding_torque, viscous_torque, viscous_loss = laws

    @kernel
    def find_twist(x: State, u: Inputs, p: Any) -> Slip:
        limit = sliding_torque(u, p)
        return find_slip(x.twist, u.rotation_rate, limit, p.sticking_stiffness, p.relaxation_time)

    @kernel
    def lost_to_friction(slip: Slip, u: Inputs, p: Any) -> float:
        dry = lost_power(slip, p.sticking_stiffness, p.relaxation_time)
        return dry + viscous_loss(u.rotation_rate, p)

    @kernel
    def derivative(t: float, x: State, u: Inputs, p: Any, dx: State) -> None:
        dx.twist = find_twist(x, u, p).rate

    @kernel
    def output(t: float, x: State, u: Inputs, p: Any, y: Outputs) -> None:
        twist = find_twist(x, u, p)
        y.friction_torque = twist.transmitted + viscous_torque(u.rotation_rate, p)
        y.sliding_torque = sliding_torque(u, p)
        y.sticking_margin = y.sliding_torque - abs(twist.sticking)
        y.sliding_rate = twist.sliding
        y.power_loss = lost_to_friction(twist, u, p)

    @kernel
    def energy(t: float, x: State, u: Inputs, p: Any, e: Vector) -> None:
        e[0] = 0.5 * p.sticking_stiffness * x.twist**2
        e[1] = lost_to_friction(find_twist(x, u, p), u, p)
        e[2] = 0.0

    turning = ("rotation_rate", "load")
    return Component(
        tolerance=FINE_TOLERANCE,
        name=name,
        description=description,
        roles=(roles.Pivot(), *more),
        **layouts(parameters, State, Inputs, Outputs),
        derivative=derivative,
        output=output,
        energy=energy,
        feedthrough={
            "friction_torque": turning,
            "sliding_torque": ("load",),
            "sticking_margin": turning,
            "sliding_rate": turning,
            "power_loss": turning,
        },
        bonds=(PowerBond("friction_torque", "rotation_rate", +1),),
        event_indicators=("sticking_margin",),
    )


def pivot_friction() -> Component:
    """T = k (z + tau omega), at most mu r |F| + T_0; z' = (T/k - z)/tau."""
    return make_pivot(
        "pivot_friction",
        "Friction of a lever's pivot: sticking, sliding and viscous",
        Parameters,
        PivotLaws(sliding_torque, viscous_torque, viscous_loss),
    )
