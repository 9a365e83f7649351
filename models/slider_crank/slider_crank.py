"""Slider-crank whose slider has clearance, with impacts and sliding on both walls, in SI units.

Farahanchi 1991 (F); see `forms` for the equations of motion, walls, energy and crank torque, `walls` for
the films on the walls. The crank's angle, speed and acceleration are given; F assumes constant speed, here
the acceleration counts too, to the order of the form.
"""

import math

from ..compile.kernel import kernel
from ..core import roles
from ..core.component import Component, Events, PowerBond
from ..core.quantities import Vector, layouts
from .checks import REQUIREMENTS, START_REQUIREMENTS
from .equations import inertia, joint_rate, rebound
from .flight.bouncing import FREE, LOWER, UPPER
from .forms import crank_impulse, crank_torque, flight_acceleration, kinetic_energy, offset, offset_slope
from .nonlinear import rod_angle, rod_rate
from .records import WALL_FILMS, Inputs, Outputs, Parameters, State, crank, mechanism
from .steady import EXTRA_WORK, make_advance
from .walls import (
    UNRESOLVED,
    Motion,
    ends_chatter,
    film_change,
    resolution,
    wall_force,
    wall_motion,
    wall_psi,
)

# Guards.
UPPER_WALL, LOWER_WALL, RELEASE = 0, 1, 2
# Two units of rounding: after an impact the slider is inside its wall.
INSIDE = 4.4e-16


@kernel
def motion(x: State, u: Inputs, p: Parameters) -> Motion:
    """By F (2.13) in flight, the wall's while sliding."""
    if x.mode != FREE:
        return wall_motion(x.mode, x, u, p)
    change = flight_acceleration(p.form, crank(u), x.psi, x.psi_rate, mechanism(p))
    return Motion(x.psi, x.psi_rate, change)


@kernel
def derivative(t: float, x: State, u: Inputs, p: Parameters, dx: State) -> None:
    now = motion(x, u, p)
    dx.psi = now.rate
    dx.psi_rate = now.change
    dx.mode = 0.0
    dx.upper_impact_count = 0.0
    dx.lower_impact_count = 0.0
    dx.upper_impact_impulse = 0.0
    dx.lower_impact_impulse = 0.0
    dx.upper_force_integral = wall_force(UPPER, now, u, p) if x.mode == UPPER else 0.0
    dx.lower_force_integral = wall_force(LOWER, now, u, p) if x.mode == LOWER else 0.0
    dx.crank_impact_impulse = 0.0
    dx.last_impact_time = 0.0
    dx.last_impact_velocity = 0.0
    dx.event_count = 0.0
    dx.last_event_time = 0.0
    dx.impact_loss = 0.0
    dx.impact_work = 0.0
    dx.upper_wall_film = x.upper_wall_film_rate
    dx.upper_wall_film_rate = film_change(
        x.upper_wall_film, x.upper_wall_film_rate, u.upper_film_thickness, p
    )
    dx.lower_wall_film = x.lower_wall_film_rate
    dx.lower_wall_film_rate = film_change(
        x.lower_wall_film, x.lower_wall_film_rate, u.lower_film_thickness, p
    )


@kernel
def guards(t: float, x: State, u: Inputs, p: Parameters, g: Vector) -> None:
    """In flight the distances (rad) to both walls; sliding, the wall's force (N)."""
    g[UPPER_WALL] = 1.0
    g[LOWER_WALL] = 1.0
    g[RELEASE] = 1.0
    if x.mode == FREE:
        g[UPPER_WALL] = wall_psi(UPPER, x, u, p) - x.psi
        g[LOWER_WALL] = x.psi - wall_psi(LOWER, x, u, p)
    else:
        g[RELEASE] = wall_force(x.mode, wall_motion(x.mode, x, u, p), u, p)


@kernel
def stored_energy(x: State, u: Inputs, p: Parameters) -> float:
    """Kinetic energy (J)."""
    now = motion(x, u, p)
    scale = p.piston_mass * p.rod_length**2
    return scale * kinetic_energy(p.form, u.crank_angle, u.crank_speed, now.psi, now.rate, mechanism(p))


@kernel
def transition(k: int, t: float, x: State, u: Inputs, p: Parameters) -> None:
    """Impact F (2.17), the beginning of sliding after the last impact, or the release of the slider."""
    before = stored_energy(x, u, p)
    if k == RELEASE:
        release(x, u, p)
        count_event(t, x)
    else:
        strike(UPPER if k == UPPER_WALL else LOWER, t, x, u, p)
    x.impact_work += stored_energy(x, u, p) - before


@kernel
def release(x: State, u: Inputs, p: Parameters) -> None:
    """Flight begins on the wall, with the wall's rate (F appendix B)."""
    on = wall_motion(x.mode, x, u, p)
    x.psi = on.psi - x.mode * INSIDE * resolution(on.psi, p)
    x.psi_rate = on.rate
    x.mode = FREE


@kernel
def count_event(t: float, x: State) -> None:
    """Count an event and note its time."""
    x.event_count += 1.0
    x.last_event_time = t


@kernel
def strike(side: float, t: float, x: State, u: Inputs, p: Parameters) -> None:
    """Impact of the slider on a wall.

    At the end of chatter the impact is plastic, the limit of the remaining ones, and sliding begins.
    """
    m = mechanism(p)
    on = wall_motion(side, x, u, p)
    slope = offset_slope(p.form, u.crank_angle, on.psi, m)
    size = resolution(on.psi, p)
    approach = side * (x.psi_rate - on.rate)
    x.psi = on.psi - side * INSIDE * size
    if approach < 0.0:  # outside a wall that has jumped, and already leaving it
        return
    count_event(t, x)
    pressing = wall_force(side, on, u, p) * slope / (inertia(m) * p.piston_mass * p.rod_length)
    slides = ends_chatter(p.restitution * approach, pressing, UNRESOLVED * size, u, p)
    restitution = 0.0 if slides else p.restitution
    after = rebound(x.psi_rate, on.rate, restitution)
    jump = after - x.psi_rate
    impulse = inertia(m) * p.piston_mass * p.rod_length * abs(jump) / slope
    velocity = approach * p.rod_length * slope
    x.impact_loss += 0.5 * (1.0 - restitution) * impulse * velocity
    # `transition` adds the change of kinetic energy; the loss in it is no work.
    x.impact_work += 0.5 * (1.0 - restitution) * impulse * velocity
    taken = crank_impulse(p.form, u.crank_angle, on.psi, jump, m)
    x.crank_impact_impulse += p.piston_mass * p.rod_length**2 * taken
    x.last_impact_time = t
    x.last_impact_velocity = velocity
    if side == UPPER:
        x.upper_impact_count += 1.0
        x.upper_impact_impulse += impulse
    else:
        x.lower_impact_count += 1.0
        x.lower_impact_impulse += impulse
    x.psi_rate = after
    if slides:
        x.mode = side


@kernel
def output(t: float, x: State, u: Inputs, p: Parameters, y: Outputs) -> None:
    m = mechanism(p)
    theta, speed = u.crank_angle, u.crank_speed
    now = motion(x, u, p)
    eta, eta_rate = rod_angle(theta, now.psi, m.xi), rod_rate(theta, speed, now.rate, m.xi)
    y.psi = now.psi
    y.psi_rate = now.rate
    y.piston_position = p.crank_radius * math.cos(theta) + p.rod_length * math.cos(eta)
    y.piston_velocity = -p.crank_radius * speed * math.sin(theta) - p.rod_length * eta_rate * math.sin(eta)
    y.piston_offset = p.rod_length * offset(p.form, theta, now.psi, m)
    y.upper_wall_force = wall_force(UPPER, now, u, p) if x.mode == UPPER else 0.0
    y.lower_wall_force = wall_force(LOWER, now, u, p) if x.mode == LOWER else 0.0
    scale = p.piston_mass * p.rod_length
    force = (y.upper_wall_force - y.lower_wall_force) / scale
    torque = crank_torque(p.form, crank(u), now.psi, now.rate, now.change, force, m)
    y.crank_torque = scale * p.rod_length * torque
    # The roller does not turn: its surface moves with the piston, the liner stands still.
    y.wall_entraining_velocity = 0.5 * y.piston_velocity
    y.wall_sliding_velocity = y.piston_velocity
    y.wall_radius = p.roller_radius
    y.sliding = x.mode
    y.impact_count = x.upper_impact_count + x.lower_impact_count
    y.upper_impact_count = x.upper_impact_count
    y.lower_impact_count = x.lower_impact_count
    y.upper_impact_impulse = x.upper_impact_impulse
    y.lower_impact_impulse = x.lower_impact_impulse
    y.upper_wall_impulse = x.upper_impact_impulse + x.upper_force_integral
    y.lower_wall_impulse = x.lower_impact_impulse + x.lower_force_integral
    y.crank_impact_impulse = x.crank_impact_impulse
    y.last_impact_time = x.last_impact_time
    y.last_impact_velocity = x.last_impact_velocity
    y.event_count = x.event_count
    y.last_event_time = x.last_event_time


@kernel
def energy(t: float, x: State, u: Inputs, p: Parameters, e: Vector) -> None:
    """Stored: kinetic energy of the form. Dissipated: joint friction, and at impacts `impact_loss`. Source:
    the film that moves the wall under a sliding piston."""
    now = motion(x, u, p)
    e[0] = stored_energy(x, u, p)
    e[1] = p.joint_friction * joint_rate(u.crank_angle, u.crank_speed, now.rate, mechanism(p)) ** 2
    e[2] = 0.0
    if x.mode != FREE:
        film_rate = x.upper_wall_film_rate if x.mode == UPPER else x.lower_wall_film_rate
        e[2] = wall_force(x.mode, now, u, p) * film_rate


def slider_crank() -> Component:
    """The slider-crank with clearance at its slider."""
    moving = ("crank_angle", "crank_speed")
    forced = (*moving, "crank_acceleration")
    films = ("upper_film_thickness", "lower_film_thickness")
    # A film's thickness sets the acceleration of its wall.
    return Component(
        name="slider_crank",
        description="Slider-crank with clearance at the slider: flight, impacts and sliding",
        roles=(roles.Crank(),),
        **layouts(Parameters, State, Inputs, Outputs),
        derivative=derivative,
        output=output,
        energy=energy,
        feedthrough={
            "psi": ("crank_angle",),
            "psi_rate": moving,
            "piston_position": ("crank_angle",),
            "piston_velocity": moving,
            "piston_offset": ("crank_angle",),
            "upper_wall_force": (*forced, "upper_film_thickness"),
            "lower_wall_force": (*forced, "lower_film_thickness"),
            "crank_torque": (*forced, *films),
            "wall_entraining_velocity": moving,
            "wall_sliding_velocity": moving,
        },
        bonds=(PowerBond("crank_torque", "crank_speed", +1),),
        events=Events(3, guards, transition),
        advance_maker=make_advance,
        extra_work=EXTRA_WORK,
        requirements=REQUIREMENTS,
        start_requirements=START_REQUIREMENTS,
        resting=WALL_FILMS,
        event_counter="event_count",
        event_time="last_event_time",
    )
