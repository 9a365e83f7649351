"""Slider-crank with a tilting piston: the crank's motion is an input, or a torque drives it."""

from ...compile.kernel import kernel
from ...core import roles
from ...core.component import Component, PowerBond
from ...core.quantities import layouts
from . import mechanics as me
from . import motion as mo
from .checks import REQUIREMENTS, START_REQUIREMENTS
from .contact import CORNERS, Motion, add_reaction, reaction
from .events import contact_events
from .mechanics import Coordinates
from .motion import FORCED_OUTPUTS
from .records import (
    DrivenInputs,
    DrivenOutputs,
    DrivenParameters,
    DrivenState,
    FreeInputs,
    FreeOutputs,
    FreeParameters,
    FreeState,
)

SIZES = {"corners": CORNERS}


@kernel
def driven_motion(x: DrivenState, u: DrivenInputs, p: DrivenParameters) -> Motion:
    """Rod and piston under their forces, the crank's acceleration given."""
    place = mo.find_place(x, p)
    q = mo.coordinates(u.crank_angle, place, p)
    v = mo.rates(u.crank_speed, q, place, p)
    matrix = me.mass_matrix(q, p)
    inverse = me.prescribed_inverse(matrix)
    forces = me.add(me.applied_forces(q, v, u.gas_pressure, p), -1.0, me.turning_forces(q, v, p))
    driven = Coordinates(
        0.0,
        forces.eta - matrix.theta_eta * u.crank_acceleration,
        forces.chi - matrix.theta_chi * u.crank_acceleration,
    )
    response = me.multiply(inverse, driven)
    return Motion(q, v, inverse, Coordinates(u.crank_acceleration, response.eta, response.chi))


@kernel
def crank_torque(x: DrivenState, u: DrivenInputs, p: DrivenParameters) -> float:
    """Torque that the mechanism takes: theta's row of the equation of motion."""
    s = driven_motion(x, u, p)
    touching = mo.find_closed_corners(x)
    push = mo.hold_closed(touching, s, p)
    q2 = add_reaction(touching, push, s.free, s, p)
    inertial = me.multiply(me.mass_matrix(s.q, p), q2).theta + me.turning_forces(s.q, s.v, p).theta
    applied = me.applied_forces(s.q, s.v, u.gas_pressure, p).theta
    return inertial - applied - reaction(touching, push, s, p).theta


@kernel
def keep_speed(
    x: DrivenState, u: DrivenInputs, s: Motion, jump: Coordinates, walls: Coordinates, p: DrivenParameters
) -> None:
    """The crank keeps its speed and gives the angular impulse that this takes."""
    impulse = me.multiply(me.mass_matrix(s.q, p), jump).theta - walls.theta
    x.crank_impact_impulse += impulse
    x.impact_work += impulse * u.crank_speed


@kernel
def driven_derivative(
    t: float, x: DrivenState, u: DrivenInputs, p: DrivenParameters, dx: DrivenState
) -> None:
    mo.differentiate(x, driven_motion(x, u, p), p, dx)
    dx.crank_impact_impulse = 0.0
    dx.impact_work = 0.0


@kernel
def driven_output(t: float, x: DrivenState, u: DrivenInputs, p: DrivenParameters, y: DrivenOutputs) -> None:
    mo.observe(x, driven_motion(x, u, p), u.gas_pressure, p, y)
    y.crank_torque = crank_torque(x, u, p)
    y.crank_impact_impulse = x.crank_impact_impulse


def piston_crank() -> Component:
    """The slider-crank with a tilting piston on a crank that is driven."""
    turning = ("crank_angle", "crank_speed")
    forced = (*turning, "crank_acceleration", "gas_pressure")
    return Component(
        name="piston_crank",
        description="Slider-crank with a piston that tilts in its bore, crank motion given",
        roles=(roles.PistonCrank(),),
        **layouts(DrivenParameters, DrivenState, DrivenInputs, DrivenOutputs, SIZES),
        derivative=driven_derivative,
        output=driven_output,
        energy=mo.make_energy(driven_motion),
        feedthrough={
            "piston_position": ("crank_angle",),
            "piston_velocity": turning,
            "rod_angle": ("crank_angle",),
            **dict.fromkeys(FORCED_OUTPUTS, forced),
            "crank_torque": forced,
        },
        bonds=(PowerBond("crank_torque", "crank_speed", +1),),
        events=contact_events(driven_motion, keep_speed),
        requirements=REQUIREMENTS,
        start_requirements=START_REQUIREMENTS,
        resting=(),
        event_counter="event_count",
        event_time="last_event_time",
    )


@kernel
def free_motion(x: FreeState, u: FreeInputs, p: FreeParameters) -> Motion:
    """Crank, rod and piston under their forces."""
    place = mo.find_place(x, p)
    q = mo.coordinates(x.crank_angle, place, p)
    v = mo.rates(x.crank_speed, q, place, p)
    inverse = me.free_inverse(me.mass_matrix(q, p))
    forces = me.add(me.applied_forces(q, v, u.gas_pressure, p), -1.0, me.turning_forces(q, v, p))
    driven = Coordinates(forces.theta + u.crank_drive, forces.eta, forces.chi)
    return Motion(q, v, inverse, me.multiply(inverse, driven))


@kernel
def take_jump(
    x: FreeState, u: FreeInputs, s: Motion, jump: Coordinates, walls: Coordinates, p: FreeParameters
) -> None:
    """The crank takes its part of the jump."""
    x.crank_speed += jump.theta


@kernel
def free_derivative(t: float, x: FreeState, u: FreeInputs, p: FreeParameters, dx: FreeState) -> None:
    dx.crank_angle = x.crank_speed
    dx.crank_speed = mo.differentiate(x, free_motion(x, u, p), p, dx).theta


@kernel
def free_output(t: float, x: FreeState, u: FreeInputs, p: FreeParameters, y: FreeOutputs) -> None:
    mo.observe(x, free_motion(x, u, p), u.gas_pressure, p, y)
    y.crank_angle = x.crank_angle
    y.crank_speed = x.crank_speed


def free_piston_crank() -> Component:
    """The slider-crank with a tilting piston on a crank of its own."""
    forced = ("crank_drive", "gas_pressure")
    return Component(
        name="free_piston_crank",
        description="Slider-crank with a piston that tilts in its bore, crank free under a torque",
        **layouts(FreeParameters, FreeState, FreeInputs, FreeOutputs, SIZES),
        derivative=free_derivative,
        output=free_output,
        energy=mo.make_energy(free_motion),
        feedthrough=dict.fromkeys(FORCED_OUTPUTS, forced),
        bonds=(PowerBond("crank_drive", "crank_speed", +1),),
        events=contact_events(free_motion, take_jump),
        requirements=REQUIREMENTS,
        start_requirements=START_REQUIREMENTS,
        resting=(),
        event_counter="event_count",
        event_time="last_event_time",
    )
