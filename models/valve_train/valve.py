"""Valve: a body with its seat, loaded by its train, by springs and by the gas."""

from dataclasses import dataclass

from ..compile.kernel import kernel
from ..core import roles
from ..core.bonds import counts_energies
from ..core.component import Component, PowerBond, check_sizes
from ..core.integrator import FINE_TOLERANCE
from ..core.quantities import Layout, Quantity, Vector
from ..plausible import LASH, SEAT_STIFFNESS, VALVE_MASS
from .valve_spring import seat_force


@dataclass
class ValveParameters:
    mass: float = Quantity(
        "kg", "mass of valve, retainer and what moves with them",
        nominal=0.1, positive=True, plausible=VALVE_MASS,
    ).default(0.1)  # fmt: skip
    lash: float = Quantity(
        "m", "position at which the valve sits on its seat", nominal=1e-4, display_unit="mm", plausible=LASH
    ).default()
    seat_stiffness: float = Quantity(
        "N/m", "stiffness of the seat", nominal=1e7, positive=True, plausible=SEAT_STIFFNESS
    ).default(2e7)
    seat_damping: float = Quantity(
        "N.s/m", "damping of the seat while touching", nominal=1e2, minimum=0.0
    ).default(300.0)
    guide_damping: float = Quantity(
        "N.s/m", "viscous friction in the guide", nominal=10.0, minimum=0.0
    ).default()


@dataclass
class ValveState:
    position: float = Quantity(
        "m", "position towards the open valve", nominal=1e-3, display_unit="mm"
    ).default()
    velocity: float = Quantity("m/s", "velocity of the valve").default()


@dataclass
class ValveInputs:
    load: float = Quantity("N", "load of the train, opening the valve", nominal=500.0).default()
    spring_force: Vector = Quantity(
        "N", "force of a spring, closing the valve", nominal=500.0, size="springs"
    ).per_element()
    gas_force: float = Quantity(
        "N", "force of the gas on the valve's head, closing it", nominal=500.0
    ).default()
    guide_friction: float = Quantity(
        "N", "friction of the guide against the velocity", nominal=10.0
    ).default()


@dataclass
class ValveOutputs(ValveState):
    acceleration: float = Quantity("m/s2", "acceleration of the valve", nominal=1e3).default()
    valve_lift: float = Quantity("m", "lift: position less lash", nominal=1e-3, display_unit="mm").default()
    seat_force: float = Quantity("N", "force of the seat on the valve", nominal=500.0).default()
    seat_dip: float = Quantity(
        "m", "dip of the valve into its seat", nominal=1e-5, display_unit="um"
    ).default()


@kernel
def accelerate(x: ValveState, u: ValveInputs, p: ValveParameters) -> float:
    force = u.load - u.gas_force + seat_force(p, x.position, x.velocity) - p.guide_damping * x.velocity
    for i in range(u.spring_force.size):
        force -= u.spring_force[i]
    return (force - u.guide_friction) / p.mass


@kernel
def derivative(t: float, x: ValveState, u: ValveInputs, p: ValveParameters, dx: ValveState) -> None:
    dx.position = x.velocity
    dx.velocity = accelerate(x, u, p)


@kernel
def output(t: float, x: ValveState, u: ValveInputs, p: ValveParameters, y: ValveOutputs) -> None:
    y.position = x.position
    y.velocity = x.velocity
    y.acceleration = accelerate(x, u, p)
    y.valve_lift = x.position - p.lash
    y.seat_force = seat_force(p, x.position, x.velocity)
    y.seat_dip = p.lash - x.position


@kernel
def energy(t: float, x: ValveState, u: ValveInputs, p: ValveParameters, e: Vector) -> None:
    """Lost: what the seat does not give back of k dip^2/2, and in the guide."""
    dip = max(0.0, p.lash - x.position)
    e[0] = 0.5 * p.mass * x.velocity**2 + 0.5 * p.seat_stiffness * dip**2
    e[1] = (
        x.velocity * (p.seat_stiffness * dip - seat_force(p, x.position, x.velocity))
        + p.guide_damping * x.velocity**2
    )
    e[2] = 0.0


@counts_energies
def valve(springs: int = 1) -> Component:
    """m y'' = load - sum of the springs' forces - gas force + seat force - F_g - c y'."""
    check_sizes(springs=springs)
    sizes = {"springs": springs}
    inputs = Layout(ValveInputs, sizes)
    forces = [f"spring_force[{i + 1}]" for i in range(springs)]
    return Component(
        tolerance=FINE_TOLERANCE,
        name="valve",
        description="Valve on its seat, under load, springs and gas",
        roles=(roles.Valve(),),
        parameters=Layout(ValveParameters),
        state=Layout(ValveState),
        inputs=inputs,
        outputs=Layout(ValveOutputs),
        derivative=derivative,
        output=output,
        energy=energy,
        feedthrough={"acceleration": inputs.names},
        bonds=(
            PowerBond("load", "velocity", +1),
            PowerBond("gas_force", "velocity", -1),
            PowerBond("guide_friction", "velocity", -1),
            *(PowerBond(force, "velocity", -1) for force in forces),
        ),
        structure=sizes,
        event_indicators=("seat_dip",),
    )
