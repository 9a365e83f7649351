"""Walls of the slider-crank with lubricant films: place, motion, and force on the slider.

A wall stands at the clearance less its film h_f, which follows the film thickness h that is given,

    T^2 h_f'' + 2 T h_f' + h_f = h,    T = film_lag,

so that its place, velocity and acceleration are consistent at every instant. A film of
constant rate is followed 2 T late.
"""

from typing import NamedTuple

from ..compile.kernel import kernel
from .flight.bouncing import CHATTER_LEFT, UPPER
from .forms import holding_force, moving_wall_acceleration, moving_wall_rate, wall_angle
from .records import Inputs, Parameters, State, crank, mechanism

# Bounces lower than this fraction of the wall's psi are rounding, and end there at the latest (at
# a restitution of 0.9 some 1e-7 rad before the end of the chatter).
UNRESOLVED = 1e-14


class Motion(NamedTuple):
    """psi, psi' and psi'' of the slider."""

    psi: float
    rate: float
    change: float


@kernel
def film_change(film: float, rate: float, thickness: float, p: Parameters) -> float:
    """h_f''."""
    return ((thickness - film) / p.film_lag - 2.0 * rate) / p.film_lag


@kernel
def wall_psi(side: float, x: State, u: Inputs, p: Parameters) -> float:
    """psi at which the slider touches that wall."""
    film = x.upper_wall_film if side == UPPER else x.lower_wall_film
    gap = side * (p.clearance - film) / p.rod_length
    return wall_angle(p.form, u.crank_angle, gap, mechanism(p))


@kernel
def wall_motion(side: float, x: State, u: Inputs, p: Parameters) -> Motion:
    """The motion of a slider that stays on that wall."""
    if side == UPPER:
        velocity = x.upper_wall_film_rate
        change = film_change(x.upper_wall_film, velocity, u.upper_film_thickness, p)
    else:
        velocity = x.lower_wall_film_rate
        change = film_change(x.lower_wall_film, velocity, u.lower_film_thickness, p)
    m, inwards = mechanism(p), -side / p.rod_length
    psi = wall_psi(side, x, u, p)
    return Motion(
        psi,
        moving_wall_rate(p.form, u.crank_angle, u.crank_speed, psi, inwards * velocity, m),
        moving_wall_acceleration(p.form, crank(u), psi, inwards * velocity, inwards * change, m),
    )


@kernel
def wall_force(side: float, on: Motion, u: Inputs, p: Parameters) -> float:
    """Force (N) with which the wall on that side holds a slider that rides `on` it.

    Negative: it would have to pull.
    """
    force = holding_force(p.form, crank(u), on.psi, on.rate, on.change, mechanism(p))
    return side * p.piston_mass * p.rod_length * force


@kernel
def resolution(psi: float, p: Parameters) -> float:
    """Size by which to judge the rounding of a wall's psi, which films may bring close to zero."""
    return max(abs(psi), p.clearance / p.rod_length)


@kernel
def ends_chatter(parting: float, pressing: float, height: float, u: Inputs, p: Parameters) -> bool:
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
