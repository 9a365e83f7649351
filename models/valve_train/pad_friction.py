"""Friction of a pad that slides to and fro: Coulomb friction that sticks (see `slider`), and viscous one.

The friction of a contact jumps where its sliding turns back. This one goes through zero there, as its
surfaces give elastically. Its dry part has the limit mu W under the load W; the whole one is T + c v_s.
"""

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
    """Defaults: mixed lubrication; under 500 N the surfaces give by 5 um before they slide."""

    friction_coefficient: float = kinds.FRICTION_COEFFICIENT("Coulomb's coefficient of friction mu", 0.1)
    viscous_coefficient: float = kinds.DAMPING("viscous friction c over velocity", nominal=1.0)
    sticking_stiffness: StickingStiffness = 1e7
    relaxation_time: RelaxationTime = 3e-5


@dataclass
class State:
    creep: Creep = 0.0


@dataclass
class Inputs:
    sliding_velocity: float = kinds.VELOCITY("velocity v_s of one surface on the other")
    load: float = kinds.FORCE("load W of the contact")


@dataclass
class Outputs:
    friction_force: float = kinds.FRICTION("friction against the sliding")
    sticking_margin: float = kinds.FRICTION("limit less what sticking would take; negative: it slides")
    slip: float = kinds.VELOCITY("velocity by which the surfaces slide")
    power_loss: float = kinds.POWER("power lost to friction", nominal=1.0)


@kernel
def find_creep(x: State, u: Inputs, p: Parameters) -> Slip:
    limit = p.friction_coefficient * max(0.0, u.load)
    return find_slip(x.creep, u.sliding_velocity, limit, p.sticking_stiffness, p.relaxation_time)


@kernel
def lost_to_friction(slip: Slip, u: Inputs, p: Parameters) -> float:
    """By the surfaces, and by viscosity."""
    dry = lost_power(slip, p.sticking_stiffness, p.relaxation_time)
    return dry + p.viscous_coefficient * u.sliding_velocity**2


@kernel
def derivative(t: float, x: State, u: Inputs, p: Parameters, dx: State) -> None:
    dx.creep = find_creep(x, u, p).rate


@kernel
def output(t: float, x: State, u: Inputs, p: Parameters, y: Outputs) -> None:
    slip = find_creep(x, u, p)
    y.friction_force = slip.transmitted + p.viscous_coefficient * u.sliding_velocity
    y.sticking_margin = p.friction_coefficient * max(0.0, u.load) - abs(slip.sticking)
    y.slip = slip.sliding
    y.power_loss = lost_to_friction(slip, u, p)


@kernel
def energy(t: float, x: State, u: Inputs, p: Parameters, e: Vector) -> None:
    e[0] = 0.5 * p.sticking_stiffness * x.creep**2
    e[1] = lost_to_friction(find_creep(x, u, p), u, p)
    e[2] = 0.0


def pad_friction() -> Component:
    """T = k (z + tau v_s), at most mu W; z' = (T/k - z)/tau."""
    moving = ("sliding_velocity", "load")
    return Component(
        tolerance=FINE_TOLERANCE,
        name="pad_friction",
        description="Friction of a pad that slides to and fro: sticking, sliding and viscous",
        roles=(roles.Surface(),),
        **layouts(Parameters, State, Inputs, Outputs),
        derivative=derivative,
        output=output,
        energy=energy,
        feedthrough=dict.fromkeys(("friction_force", "sticking_margin", "slip", "power_loss"), moving),
        bonds=(PowerBond("friction_force", "sliding_velocity", +1),),
        event_indicators=("sticking_margin",),
    )
