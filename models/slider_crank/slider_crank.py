"""Slider-crank whose slider has clearance, with impacts and sliding on both walls, in SI units.

Farahanchi 1991 (F); see `forms` for the equations of motion, walls, energy and crank torque. The crank's
angle, speed and acceleration are given; F assumes constant speed, here the acceleration enters exactly to
the order of the form.

Neglected while sliding: the film's rate in velocities, wall force and crank torque, and its acceleration
(a film's dh/dt is some 1e-3 of the impact velocities, and no output then depends on a film's rate, which
a contact computes from them). What that is worth in energy is booked as a source. Impacts see the rate.
"""

from __future__ import annotations

import math

from ..component import Component, Events, PowerBond
from ..kernel import kernel
from ..quantities import Layout, Vector
from .bouncing import CHATTER_LEFT, FREE, LOWER, UPPER
from .checks import check, check_start
from .equations import inertia, joint_rate, rebound
from .forms import (
    constraint_force,
    crank_impulse,
    crank_torque,
    energy_slope,
    flight_acceleration,
    kinetic_energy,
    momentum,
    offset,
    offset_slope,
    wall_acceleration,
    wall_angle,
    wall_rate,
    wall_rate_slope,
)
from .nonlinear import rod_angle, rod_rate
from .records import (
    SliderCrankInputs,
    SliderCrankOutputs,
    SliderCrankParameters,
    SliderCrankState,
    mechanism,
)
from .steady import EXTRA_WORK, make_advance

# Guards.
UPPER_WALL, LOWER_WALL, RELEASE = 0, 1, 2
# Two units of rounding: after an impact the slider is inside its wall.
INSIDE = 4.4e-16
# Bounces lower than this fraction of the wall's psi drown in its rounding, and end there at the latest (at
# a restitution of 0.9 some 1e-7 rad before the end of the chatter).
UNRESOLVED = 1e-14


@kernel
def gap(side: float, u: SliderCrankInputs, p: SliderCrankParameters) -> float:
    """Distance of a wall from the centre less its film, in rod lengths."""
    film = u.upper_film_thickness if side == UPPER else u.lower_film_thickness
    return (p.clearance - film) / p.rod_length


@kernel
def film_push(side: float, psi: float, u: SliderCrankInputs, p: SliderCrankParameters) -> float:
    """The part of the wall's psi rate that comes from the film's rate."""
    film_rate = u.upper_film_rate if side == UPPER else u.lower_film_rate
    return -side * film_rate / p.rod_length / offset_slope(p.form, u.crank_angle, psi, mechanism(p))


@kernel
def wall(side: float, u: SliderCrankInputs, p: SliderCrankParameters) -> float:
    """psi at which the slider touches that wall."""
    return wall_angle(p.form, u.crank_angle, side * gap(side, u, p), mechanism(p))


@kernel
def angle(x: SliderCrankState, u: SliderCrankInputs, p: SliderCrankParameters) -> float:
    """psi: the state in flight, the wall's while sliding."""
    if x.mode == FREE:
        return x.psi
    return wall(x.mode, u, p)


@kernel
def angle_rate(x: SliderCrankState, psi: float, u: SliderCrankInputs, p: SliderCrankParameters) -> float:
    """psi': the state in flight, that of the wall behind a film at rest while sliding."""
    if x.mode == FREE:
        return x.psi_rate
    return wall_rate(p.form, u.crank_angle, u.crank_speed, psi, mechanism(p))


@kernel
def angle_acceleration(
    x: SliderCrankState, psi: float, rate: float, u: SliderCrankInputs, p: SliderCrankParameters
) -> float:
    """psi'', by F (2.13) in flight, the wall's while sliding."""
    theta, speed, acceleration, m = u.crank_angle, u.crank_speed, u.crank_acceleration, mechanism(p)
    if x.mode == FREE:
        return flight_acceleration(p.form, theta, speed, acceleration, psi, rate, m)
    return wall_acceleration(p.form, theta, speed, acceleration, psi, m)


@kernel
def wall_force(side: float, psi: float, u: SliderCrankInputs, p: SliderCrankParameters) -> float:
    """Force (N) with which the wall on that side would hold the slider; negative: it would have to pull."""
    m = mechanism(p)
    force = constraint_force(p.form, u.crank_angle, u.crank_speed, u.crank_acceleration, psi, m)
    return side * p.piston_mass * p.rod_length * force


@kernel
def derivative(
    t: float, x: SliderCrankState, u: SliderCrankInputs, p: SliderCrankParameters, dx: SliderCrankState
) -> None:
    psi = angle(x, u, p)
    rate = angle_rate(x, psi, u, p)
    dx.psi = rate
    dx.psi_rate = angle_acceleration(x, psi, rate, u, p)
    dx.mode = 0.0
    dx.upper_impact_count = 0.0
    dx.lower_impact_count = 0.0
    dx.upper_impact_impulse = 0.0
    dx.lower_impact_impulse = 0.0
    dx.upper_force_integral = wall_force(UPPER, psi, u, p) if x.mode == UPPER else 0.0
    dx.lower_force_integral = wall_force(LOWER, psi, u, p) if x.mode == LOWER else 0.0
    dx.crank_impact_impulse = 0.0
    dx.last_impact_time = 0.0
    dx.last_impact_velocity = 0.0
    dx.impact_loss = 0.0
    dx.impact_work = 0.0
    if x.mode != FREE:
        push = film_push(x.mode, psi, u, p)
        dx.psi += push
        dx.psi_rate += wall_rate_slope(p.form, u.crank_angle, u.crank_speed, psi, mechanism(p)) * push


@kernel
def guards(t: float, x: SliderCrankState, u: SliderCrankInputs, p: SliderCrankParameters, g: Vector) -> None:
    """In flight the distances (rad) to both walls; sliding, the wall's force (N)."""
    g[UPPER_WALL] = 1.0
    g[LOWER_WALL] = 1.0
    g[RELEASE] = 1.0
    if x.mode == FREE:
        g[UPPER_WALL] = wall(UPPER, u, p) - x.psi
        g[LOWER_WALL] = x.psi - wall(LOWER, u, p)
    else:
        g[RELEASE] = wall_force(x.mode, angle(x, u, p), u, p)


@kernel
def energy_now(x: SliderCrankState, u: SliderCrankInputs, p: SliderCrankParameters) -> float:
    """Kinetic energy (J)."""
    psi = angle(x, u, p)
    rate = angle_rate(x, psi, u, p)
    scale = p.piston_mass * p.rod_length**2
    return scale * kinetic_energy(p.form, u.crank_angle, u.crank_speed, psi, rate, mechanism(p))


@kernel
def transition(k: int, t: float, x: SliderCrankState, u: SliderCrankInputs, p: SliderCrankParameters) -> None:
    """Impact F (2.17), the beginning of sliding after the last impact, or the release of the slider."""
    before = energy_now(x, u, p)
    if k == RELEASE:
        release(x, u, p)
    else:
        strike(UPPER if k == UPPER_WALL else LOWER, t, x, u, p)
    x.impact_work += energy_now(x, u, p) - before


@kernel
def release(x: SliderCrankState, u: SliderCrankInputs, p: SliderCrankParameters) -> None:
    """Flight begins on the wall, with the wall's rate (F appendix B)."""
    psi = angle(x, u, p)
    x.psi_rate = angle_rate(x, psi, u, p) + film_push(x.mode, psi, u, p)
    x.psi = psi - x.mode * INSIDE * abs(psi)
    x.mode = FREE


@kernel
def ends_chatter(
    parting: float, pressing: float, height: float, u: SliderCrankInputs, p: SliderCrankParameters
) -> bool:
    """True if a slider that leaves its wall with the rate `parting` is to slide on it instead.

    `pressing` is the acceleration towards the wall; bounces have the size of rounding when they rise less
    than `height`. What remains of the bounces lasts T = 2 parting / ((1 - e) pressing), in which the crank
    turns by |theta'| T + |theta''| T^2/2.
    """
    if pressing < 0.0:
        return False
    slow = parting <= p.sliding_threshold * abs(u.crank_speed)
    low = parting**2 <= 2.0 * pressing * height
    lost = (1.0 - p.restitution) * pressing
    turned = 2.0 * parting * (abs(u.crank_speed) * lost + abs(u.crank_acceleration) * parting)
    return slow or low or turned < CHATTER_LEFT * lost**2


@kernel
def strike(
    side: float, t: float, x: SliderCrankState, u: SliderCrankInputs, p: SliderCrankParameters
) -> None:
    """The slider has reached a wall.

    At the end of chatter it slides: then this impact is plastic, the limit of the remaining ones.
    """
    m = mechanism(p)
    psi = wall(side, u, p)
    slope = offset_slope(p.form, u.crank_angle, psi, m)
    rate_of_wall = wall_rate(p.form, u.crank_angle, u.crank_speed, psi, m) + film_push(side, psi, u, p)
    approach = side * (x.psi_rate - rate_of_wall)
    x.psi = psi - side * INSIDE * abs(psi)
    if approach < 0.0:  # found outside a wall that has jumped, and leaving already
        return
    pressing = wall_force(side, psi, u, p) * slope / (inertia(m) * p.piston_mass * p.rod_length)
    slides = ends_chatter(p.restitution * approach, pressing, UNRESOLVED * abs(psi), u, p)
    restitution = 0.0 if slides else p.restitution
    after = rebound(x.psi_rate, rate_of_wall, restitution)
    jump = after - x.psi_rate
    impulse = inertia(m) * p.piston_mass * p.rod_length * abs(jump) / slope
    velocity = approach * p.rod_length * slope
    x.impact_loss += 0.5 * (1.0 - restitution) * impulse * velocity
    # What is lost has left the kinetic energy, not entered it as work.
    x.impact_work += 0.5 * (1.0 - restitution) * impulse * velocity
    taken = crank_impulse(p.form, u.crank_angle, psi, jump, m)
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
def output(
    t: float, x: SliderCrankState, u: SliderCrankInputs, p: SliderCrankParameters, y: SliderCrankOutputs
) -> None:
    m = mechanism(p)
    theta, speed = u.crank_angle, u.crank_speed
    psi = angle(x, u, p)
    rate = angle_rate(x, psi, u, p)
    eta, eta_rate = rod_angle(theta, psi, m.xi), rod_rate(theta, speed, rate, m.xi)
    y.psi = psi
    y.psi_rate = rate
    y.piston_position = p.crank_radius * math.cos(theta) + p.rod_length * math.cos(eta)
    y.piston_velocity = -p.crank_radius * speed * math.sin(theta) - p.rod_length * eta_rate * math.sin(eta)
    y.piston_offset = p.rod_length * offset(p.form, theta, psi, m)
    y.upper_wall_force = wall_force(UPPER, psi, u, p) if x.mode == UPPER else 0.0
    y.lower_wall_force = wall_force(LOWER, psi, u, p) if x.mode == LOWER else 0.0
    y.crank_torque = (
        p.piston_mass
        * p.rod_length**2
        * crank_torque(
            p.form,
            theta,
            speed,
            u.crank_acceleration,
            psi,
            rate,
            angle_acceleration(x, psi, rate, u, p),
            (y.upper_wall_force - y.lower_wall_force) / (p.piston_mass * p.rod_length),
            m,
        )
    )
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


@kernel
def energy(t: float, x: SliderCrankState, u: SliderCrankInputs, p: SliderCrankParameters, e: Vector) -> None:
    """Stored: kinetic energy of the form, and what impacts lost less what they were given
    (so that it is continuous). Dissipated: joint friction. Source: the moving film under a sliding
    piston, which the velocities neglect."""
    m = mechanism(p)
    theta, speed = u.crank_angle, u.crank_speed
    psi = angle(x, u, p)
    rate = angle_rate(x, psi, u, p)
    scale = p.piston_mass * p.rod_length**2
    e[0] = energy_now(x, u, p) + x.impact_loss - x.impact_work
    e[1] = p.joint_friction * joint_rate(theta, speed, rate, m) ** 2
    e[2] = 0.0
    if x.mode != FREE:
        push = scale * film_push(x.mode, psi, u, p)
        e[2] = push * energy_slope(p.form, theta, speed, psi, rate, m)
        e[2] += (
            push
            * wall_rate_slope(p.form, theta, speed, psi, m)
            * momentum(p.form, theta, speed, psi, rate, m)
        )


def slider_crank() -> Component:
    """The slider-crank with clearance at its slider."""
    place = ("crank_angle", "upper_film_thickness", "lower_film_thickness")
    moving = (*place, "crank_speed")
    forced = ("crank_angle", "crank_speed", "crank_acceleration")
    return Component(
        name="slider_crank",
        description="Slider-crank with clearance at the slider: flight, impacts and sliding",
        parameters=Layout(SliderCrankParameters),
        state=Layout(SliderCrankState),
        inputs=Layout(SliderCrankInputs),
        outputs=Layout(SliderCrankOutputs),
        derivative=derivative,
        output=output,
        energy=energy,
        feedthrough={
            "psi": place,
            "psi_rate": moving,
            "piston_position": place,
            "piston_velocity": moving,
            "piston_offset": place,
            "upper_wall_force": (*forced, "upper_film_thickness"),
            "lower_wall_force": (*forced, "lower_film_thickness"),
            "crank_torque": (*moving, "crank_acceleration"),
            "wall_entraining_velocity": moving,
            "wall_sliding_velocity": moving,
        },
        bonds=(PowerBond("crank_torque", "crank_speed", +1),),
        events=Events(3, guards, transition),
        advance_maker=make_advance,
        extra_work=EXTRA_WORK,
        check=check,
        check_start=check_start,
        runs_on=True,
        input_rates={
            "upper_film_rate": "upper_film_thickness",
            "lower_film_rate": "lower_film_thickness",
        },
    )
