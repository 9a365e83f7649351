"""Requirements on several parameters or start values of the slider-crank."""

import math
from typing import NamedTuple

from ..compile.kernel import kernel
from ..core.quantities import Vector
from ..core.requirements import require
from .crank import crank_turns
from .flight.bouncing import LOWER, UPPER
from .forms import NONLINEAR
from .records import Inputs, Parameters, State
from .walls import wall_psi

# psi of the linear forms, in rad: sin psi is psi to 0.2 % there.
SMALL_ANGLE = 0.1
# Tolerances of a typed start psi, as parts of the travel: outside a wall in flight, and beside the wall on
# which it slides (there psi is computed from the wall).
OUTSIDE, BESIDE = 1e-6, 0.05


@require(
    "clearance = {0:g} m: must be at most {1:g} m, so that psi stays below {2:g} rad; form = nonlinear "
    "allows more"
)
def is_almost_linear(p: Parameters, numbers: Vector) -> bool:
    """Linear forms need a small psi; checked if the crank can turn."""
    if p.form == NONLINEAR or p.crank_radius >= p.rod_length:
        return True
    # psi <= gap / sqrt(1 - xi^2).
    largest = SMALL_ANGLE * math.sqrt(p.rod_length**2 - p.crank_radius**2)
    numbers[0], numbers[1], numbers[2] = p.clearance, largest, SMALL_ANGLE
    return p.clearance <= largest


@require(
    "clearance = {0:g} m: must be less than rod_length - crank_radius = {1:g} m, or the rod stands "
    "across the cylinder"
)
def rod_stays_along(p: Parameters, numbers: Vector) -> bool:
    """The nonlinear form needs a rod that cannot stand across; checked if the crank can turn."""
    room = p.rod_length - p.crank_radius
    numbers[0], numbers[1] = p.clearance, room
    return p.form != NONLINEAR or room <= 0.0 or p.clearance < room


class Room(NamedTuple):
    """Where the walls are at the start, and what is between them: psi in rad."""

    upper: float
    lower: float
    travel: float


@kernel
def measure_room(x: State, u: Inputs, p: Parameters) -> Room:
    upper, lower = wall_psi(UPPER, x, u, p), wall_psi(LOWER, x, u, p)
    return Room(upper, lower, upper - lower)


@require(
    "psi = {0:g} rad: there is no room between the walls, whose films of {1:g} m (upper) and {2:g} m "
    "(lower) fill the clearance of {3:g} m; widen the clearance or start with thinner films"
)
def films_leave_room(x: State, u: Inputs, p: Parameters, numbers: Vector) -> bool:
    numbers[0], numbers[1], numbers[2], numbers[3] = x.psi, x.upper_wall_film, x.lower_wall_film, p.clearance
    return measure_room(x, u, p).travel >= 0.0


@require(
    "mode = {1:g} (sliding on the {word} wall): needs psi = {2:.9g} rad, where that wall is at "
    "crank_angle = {3:g} rad, not {4:g} rad; set that psi, or mode = 0",
    words=("lower", "upper"),
)
def slides_on_a_wall(x: State, u: Inputs, p: Parameters, numbers: Vector) -> bool:
    """A slider with mode +-1 is on that wall; checked if there is room."""
    walls = measure_room(x, u, p)
    on_upper = x.mode > 0.0
    required = walls.upper if on_upper else walls.lower
    numbers[0] = 1.0 if on_upper else 0.0
    numbers[1], numbers[2], numbers[3], numbers[4] = x.mode, required, u.crank_angle, x.psi
    return x.mode == 0.0 or not walls.travel >= 0.0 or abs(x.psi - required) <= BESIDE * walls.travel


@require(
    "psi = {0:g} rad (deviation of the rod): must be from {1:.9g} to {2:.9g} rad, the walls' at "
    "crank_angle = {3:g} rad; start between them or widen the clearance"
)
def starts_between_walls(x: State, u: Inputs, p: Parameters, numbers: Vector) -> bool:
    """A free slider is between the walls; checked if there is room."""
    walls = measure_room(x, u, p)
    slack = OUTSIDE * walls.travel
    numbers[0], numbers[1], numbers[2], numbers[3] = x.psi, walls.lower, walls.upper, u.crank_angle
    inside = walls.lower - slack <= x.psi <= walls.upper + slack
    return x.mode != 0.0 or not walls.travel >= 0.0 or inside


REQUIREMENTS = (crank_turns, is_almost_linear, rod_stays_along)
START_REQUIREMENTS = (films_leave_room, slides_on_a_wall, starts_between_walls)
