"""Slider-crank with a tilting piston; a torque drives the crank."""

from ...compile.kernel import kernel
from ...core.bonds import counts_energies
from ...core.component import Component, PowerBond
from ...core.quantities import layouts
from .checks import REQUIREMENTS, START_REQUIREMENTS
from .contact import CORNERS, Motion
from .events import contact_events
from .mechanics import (
    Coordinates,
    Machine,
    add,
    applied_forces,
    free_inverse,
    mass_matrix,
    multiply,
    turning_forces,
)
from .motion import (
    FORCED_OUTPUTS,
    coordinates,
    differentiate,
    find_place,
    machine,
    make_energy,
    observe,
    rates,
)
from .records import FreePistonCrankInputs, FreePistonCrankOutputs, FreePistonCrankState, FreePistonParameters


@kernel
def motion(x: FreePistonCrankState, u: FreePistonCrankInputs, p: FreePistonParameters) -> Motion:
    """Crank, rod and piston under their forces."""
    m = machine(p)
    place = find_place(x, m)
    q = coordinates(x.crank_angle, place, m)
    v = rates(x.crank_speed, q, place, m)
    inverse = free_inverse(mass_matrix(q, m))
    forces = add(applied_forces(q, v, u.gas_pressure, m), -1.0, turning_forces(q, v, m))
    driven = Coordinates(forces.theta + u.crank_drive, forces.eta, forces.chi)
    return Motion(q, v, inverse, multiply(inverse, driven))


@kernel
def apply_to_crank(
    x: FreePistonCrankState,
    u: FreePistonCrankInputs,
    s: Motion,
    jump: Coordinates,
    walls: Coordinates,
    m: Machine,
) -> None:
    """The crank takes its part of the jump."""
    x.crank_speed += jump.theta


@kernel
def derivative(
    t: float,
    x: FreePistonCrankState,
    u: FreePistonCrankInputs,
    p: FreePistonParameters,
    dx: FreePistonCrankState,
) -> None:
    dx.crank_angle = x.crank_speed
    dx.crank_speed = differentiate(x, motion(x, u, p), p, machine(p), dx).theta


@kernel
def output(
    t: float,
    x: FreePistonCrankState,
    u: FreePistonCrankInputs,
    p: FreePistonParameters,
    y: FreePistonCrankOutputs,
) -> None:
    observe(x, motion(x, u, p), u.gas_pressure, p, machine(p), y)
    y.crank_angle = x.crank_angle
    y.crank_speed = x.crank_speed


@counts_energies
def free_piston_crank() -> Component:
    """The slider-crank with a tilting piston on a crank of its own."""
    forced = ("crank_drive", "gas_pressure")
    sizes = {"corners": CORNERS}
    return Component(
        name="free_piston_crank",
        description="Slider-crank with a piston that tilts in its bore, crank free under a torque",
        **layouts(
            FreePistonParameters, FreePistonCrankState, FreePistonCrankInputs, FreePistonCrankOutputs, sizes
        ),
        derivative=derivative,
        output=output,
        energy=make_energy(motion),
        feedthrough=dict.fromkeys(FORCED_OUTPUTS, forced),
        bonds=(PowerBond("crank_drive", "crank_speed", +1),),
        events=contact_events(motion, apply_to_crank),
        requirements=REQUIREMENTS,
        start_requirements=START_REQUIREMENTS,
        resting=(),
        event_counter="event_count",
        event_time="last_event_time",
    )
