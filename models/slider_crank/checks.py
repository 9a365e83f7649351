"""What the ranges of parameters and start states alone cannot say."""

from __future__ import annotations

import math
from collections.abc import Sequence

from .equations import Mechanism
from .forms import NONLINEAR, wall_angle
from .records import SliderCrankInputs, SliderCrankParameters, SliderCrankState

# psi of the linear forms, in rad: sin psi is psi to 0.2 % there.
SMALL_ANGLE = 0.1
# A start psi is typed in some digits, and sliding it is the wall's anyway: outside a wall, or off the wall
# on which it is to slide, by this part of the travel it is taken to be on it.
OUTSIDE, BESIDE = 1e-6, 0.05


def check(p: SliderCrankParameters) -> Sequence[str]:
    """Messages for parameters that do not fit together."""
    if p.crank_radius >= p.rod_length:
        return [
            f"crank_radius = {p.crank_radius:g} m: must be less than rod_length = {p.rod_length:g} m, "
            "or the crank cannot turn"
        ]
    if p.form == NONLINEAR:
        return _fit(p)
    # psi <= gap / sqrt(1 - xi^2).
    largest = SMALL_ANGLE * math.sqrt(p.rod_length**2 - p.crank_radius**2)
    if p.clearance > largest:
        return [
            f"clearance = {p.clearance:g} m: must be at most {largest:g} m, so that psi stays below "
            f"{SMALL_ANGLE:g} rad; form = nonlinear allows more"
        ]
    return []


def _fit(p: SliderCrankParameters) -> Sequence[str]:
    room = p.rod_length - p.crank_radius
    if p.clearance < room:
        return []
    return [
        f"clearance = {p.clearance:g} m: must be less than rod_length - crank_radius = {room:g} m, or the "
        "rod stands across the cylinder"
    ]


def check_start(p: SliderCrankParameters, x: SliderCrankState, u: SliderCrankInputs) -> Sequence[str]:
    """Messages for a slider that begins outside its walls, or slides where it is not."""
    m = Mechanism(p.crank_radius / p.rod_length, 0.0, 0.0, 0.0, 0.0)
    films = x.upper_wall_film, x.lower_wall_film
    upper, lower = (
        wall_angle(p.form, u.crank_angle, side * (p.clearance - film) / p.rod_length, m)
        for side, film in zip((1.0, -1.0), films, strict=True)
    )
    travel = upper - lower
    if not travel >= 0.0:
        return [
            f"psi = {x.psi:g} rad: there is no room between the walls, whose films of {films[0]:g} m (upper) "
            f"and {films[1]:g} m (lower) fill the clearance of {p.clearance:g} m; widen the clearance or "
            "start with thinner films"
        ]
    if x.mode != 0.0:
        name, wall = ("upper", upper) if x.mode > 0.0 else ("lower", lower)
        if abs(x.psi - wall) <= BESIDE * travel:
            return []
        return [
            f"mode = {x.mode:g} (sliding on the {name} wall): needs psi = {wall:.9g} rad, where that wall is "
            f"at crank_angle = {u.crank_angle:g} rad, not {x.psi:g} rad; set that psi, or mode = 0"
        ]
    if lower - OUTSIDE * travel <= x.psi <= upper + OUTSIDE * travel:
        return []
    return [
        f"psi = {x.psi:g} rad (deviation of the rod): must be from {lower:.9g} to {upper:.9g} rad, "
        f"the walls' at crank_angle = {u.crank_angle:g} rad; start between them or widen the clearance"
    ]
