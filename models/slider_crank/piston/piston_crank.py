"""Slider-crank with a tilting piston; the crank's motion is an input."""

from ...compile.kernel import kernel
from ...core import roles
from ...core.bonds import counts_energies
from ...core.component import Component, PowerBond
from ...core.quantities import layouts
from .checks import REQUIREMENTS, START_REQUIREMENTS
from .contact import CORNERS, Motion, add_reaction, reaction
from .events import contact_events
from .mechanics import (
    Coordinates,
    Machine,
    add,
    applied_forces,
    mass_matrix,
    multiply,
    prescribed_inverse,
    turning_forces,
)
from .motion import (
    FORCED_OUTPUTS,
    coordinates,
    differentiate,
    find_closed_corners,
    find_place,
    hold_closed,
    machine,
    make_energy,
    observe,
    rates,
)
from .records import PistonCrankInputs, PistonCrankOutputs, PistonCrankState, PistonParameters


@kernel
def motion(x: PistonCrankState, u: PistonCrankInputs, p: PistonParameters) -> Motion:
    """Rod and piston under their forces, the crank's acceleration given."""
    m = machine(p)
    place = find_place(x, m)
    q = coordinates(u.crank_angle, place, m)
    v = rates(u.crank_speed, q, place, m)
    matrix = mass_matrix(q, m)
    inverse = prescribed_inverse(matrix)
    forces = add(applied_forces(q, v, u.gas_pressure, m), -1.0, turning_forces(q, v, m))
    driven = Coordinates(
        0.0,
        forces.eta - matrix.theta_eta * u.crank_acceleration,
        forces.chi - matrix.theta_chi * u.crank_acceleration,
    )
    response = multiply(inverse, driven)
    return Motion(q, v, inverse, Coordinates(u.crank_acceleration, response.eta, response.chi))


@kernel
def crank_torque(x: PistonCrankState, u: PistonCrankInputs, p: PistonParameters) -> float:
    """Torque that the mechanism takes: theta's row of the equation of motion."""
    m, s = machine(p), motion(x, u, p)
    push = hold_closed(find_closed_corners(x), s, p, m)
    q2 = add_reaction(push, s.free, s, m)
    inertial = multiply(mass_matrix(s.q, m), q2).theta + turning_forces(s.q, s.v, m).theta
    return inertial - applied_forces(s.q, s.v, u.gas_pressure, m).theta - reaction(push, s, m).theta


@kernel
def apply_to_crank(
    x: PistonCrankState, u: PistonCrankInputs, s: Motion, jump: Coordinates, walls: Coordinates, m: Machine
) -> None:
    """The crank keeps its speed and gives the angular impulse that this takes."""
    impulse = multiply(mass_matrix(s.q, m), jump).theta - walls.theta
    x.crank_impact_impulse += impulse
    x.impact_work += impulse * u.crank_speed


@kernel
def derivative(
    t: float, x: PistonCrankState, u: PistonCrankInputs, p: PistonParameters, dx: PistonCrankState
) -> None:
    differentiate(x, motion(x, u, p), p, machine(p), dx)
    dx.crank_impact_impulse = 0.0
    dx.impact_work = 0.0


@kernel
def output(
    t: float, x: PistonCrankState, u: PistonCrankInputs, p: PistonParameters, y: PistonCrankOutputs
) -> None:
    observe(x, motion(x, u, p), u.gas_pressure, p, machine(p), y)
    y.crank_torque = crank_torque(x, u, p)
    y.crank_impact_impulse = x.crank_impact_impulse


@counts_energies
def piston_crank() -> Component:
    """The slider-crank with a tilting piston on a crank that is driven."""
    turning = ("crank_angle", "crank_speed")
    forced = (*turning, "crank_acceleration", "gas_pressure")
    sizes = {"corners": CORNERS}
    return Component(
        name="piston_crank",
        description="Slider-crank with a piston that tilts in its bore, crank motion given",
        roles=(roles.PistonCrank(),),
        **layouts(PistonParameters, PistonCrankState, PistonCrankInputs, PistonCrankOutputs, sizes),
        derivative=derivative,
        output=output,
        energy=make_energy(motion),
        feedthrough={
            "piston_position": ("crank_angle",),
            "piston_velocity": turning,
            "rod_angle": ("crank_angle",),
            **dict.fromkeys(FORCED_OUTPUTS, forced),
            "crank_torque": forced,
        },
        bonds=(PowerBond("crank_torque", "crank_speed", +1),),
        events=contact_events(motion, apply_to_crank),
        requirements=REQUIREMENTS,
        start_requirements=START_REQUIREMENTS,
        resting=(),
        event_counter="event_count",
        event_time="last_event_time",
    )
