"""Valve: a body with its seat, loaded by its train, by springs and by the gas."""

from dataclasses import dataclass

from .. import kinds
from ..compile.kernel import kernel
from ..core import roles
from ..core.component import Component, PowerBond, check_sizes
from ..core.integrator import FINE_TOLERANCE
from ..core.quantities import Vector, layouts
from ..plausible import VALVE_MASS
from .valve_spring import NO_SEAT, seat_force


@dataclass
class Parameters:
    mass: float = kinds.MASS(
        "mass of valve, retainer and what moves with them",
        0.1,
        nominal=0.1,
        positive=True,
        plausible=VALVE_MASS,
    )
    lash: float = kinds.LASH("position at which the valve is closed")
    seat_stiffness: float = kinds.SEAT_STIFFNESS(
        "stiffness of the seat; 0: no seat", 2e7, nominal=1e7, minimum=0.0
    )
    seat_damping: float = kinds.DAMPING("damping of the seat while touching", 300.0, nominal=1e2)
    guide_damping: float = kinds.DAMPING("viscous friction in the guide", nominal=10.0)


@dataclass
class State:
    position: float = kinds.DISPLACEMENT("position towards the open valve")
    velocity: float = kinds.VELOCITY("velocity of the valve")


@dataclass
class Inputs:
    load: float = kinds.FORCE("load of the train, opening the valve")
    spring_force: Vector = kinds.FORCE.each("force of a spring, closing the valve", "springs")
    gas_force: float = kinds.FORCE("force of the gas on the valve's head, closing it")
    guide_friction: float = kinds.FRICTION("friction of the guide against the velocity")


@dataclass
class Outputs(State):
    acceleration: float = kinds.ACCELERATION("acceleration of the valve")
    valve_lift: float = kinds.DISPLACEMENT("lift: position less lash")
    seat_force: float = kinds.FORCE("force of the seat on the valve")
    seat_dip: float = kinds.DEFLECTION("dip of the valve into its seat; -1 m without a seat", NO_SEAT)


@kernel
def accelerate(x: State, u: Inputs, p: Parameters) -> float:
    force = u.load - u.gas_force + seat_force(p, x.position, x.velocity) - p.guide_damping * x.velocity
    for i in range(u.spring_force.size):
        force -= u.spring_force[i]
    return (force - u.guide_friction) / p.mass


@kernel
def derivative(t: float, x: State, u: Inputs, p: Parameters, dx: State) -> None:
    dx.position = x.velocity
    dx.velocity = accelerate(x, u, p)


@kernel
def output(t: float, x: State, u: Inputs, p: Parameters, y: Outputs) -> None:
    y.position = x.position
    y.velocity = x.velocity
    y.acceleration = accelerate(x, u, p)
    y.valve_lift = x.position - p.lash
    y.seat_force = seat_force(p, x.position, x.velocity)
    y.seat_dip = p.lash - x.position if p.seat_stiffness > 0.0 else NO_SEAT


@kernel
def energy(t: float, x: State, u: Inputs, p: Parameters, e: Vector) -> None:
    """Lost: what the seat does not give back of k dip^2/2, and in the guide."""
    dip = max(0.0, p.lash - x.position)
    e[0] = 0.5 * p.mass * x.velocity**2 + 0.5 * p.seat_stiffness * dip**2
    e[1] = (
        x.velocity * (p.seat_stiffness * dip - seat_force(p, x.position, x.velocity))
        + p.guide_damping * x.velocity**2
    )
    e[2] = 0.0


def valve(springs: int = 1) -> Component:
    """m y'' = load - sum of the springs' forces - gas force + seat force - F_g - c y'."""
    check_sizes(springs=springs)
    sizes = {"springs": springs}
    records = layouts(Parameters, State, Inputs, Outputs, sizes)
    inputs = records["inputs"].names
    forces = [f"spring_force[{i + 1}]" for i in range(springs)]
    return Component(
        tolerance=FINE_TOLERANCE,
        name="valve",
        description="Valve on its seat, under load, springs and gas",
        roles=(roles.Valve(),),
        **records,
        derivative=derivative,
        output=output,
        energy=energy,
        feedthrough={"acceleration": inputs},
        bonds=(
            PowerBond("load", "velocity", +1),
            PowerBond("gas_force", "velocity", -1),
            PowerBond("guide_friction", "velocity", -1),
            *(PowerBond(force, "velocity", -1) for force in forces),
        ),
        structure=sizes,
        event_indicators=("seat_dip",),
    )
