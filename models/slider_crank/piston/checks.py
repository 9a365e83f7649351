"""Requirements on several parameters or start values of the slider-crank with a tilting piston."""

import math
from typing import Any

from ...compile.kernel import kernel
from ...core.quantities import Vector
from ...core.requirements import require
from .contact import CORNERS, exists, gap

NAMES = ("upper front", "upper rear", "lower front", "lower rear")
# Names of corners that are closed together, by the number of `encode_closed_corners`.
NAMES_TOGETHER = tuple(
    " and ".join(name for i, name in enumerate(NAMES) if closed >> i & 1) for closed in range(1 << CORNERS)
)
# A corner may start this share of the clearance outside its wall: room for rounding of given numbers.
ROUNDING = 1e-9


@require(
    "crank_radius = {0:g} m: must be less than {1:g} m, the rod_length less clearance and place of the "
    "pin, or the crank cannot turn"
)
def crank_turns(p: Any, numbers: Vector) -> bool:
    # The largest offset of the pin: the piston in a corner of its play.
    play = p.clearance + abs(p.pin_offset) + abs(p.pin_height)
    numbers[0], numbers[1] = p.crank_radius, p.rod_length - play
    return p.crank_radius + play < p.rod_length


@require(
    "half_length = {0:g} m: must be more than {1:g} m for this half_height and clearance, or the piston "
    "can turn over in its bore; 0 makes it a roller"
)
def piston_stays_upright(p: Any, numbers: Vector) -> bool:
    """A roller may turn over."""
    least = math.sqrt(p.clearance * (2.0 * p.half_height + p.clearance))
    numbers[0], numbers[1] = p.half_length, least
    return p.half_length <= 0.0 or p.half_length > least


@kernel
def encode_closed_corners(x: Any) -> int:
    """The closed corners as a number with a bit for each."""
    closed = 0
    for i in range(CORNERS):
        if x.closed[i] != 0.0:
            closed |= 1 << i
    return closed


@kernel
def has_its_closed_corners(x: Any, p: Any) -> bool:
    absent = 0
    for i in range(CORNERS):
        if x.closed[i] != 0.0 and not exists(i, p):
            absent += 1
    return absent == 0


@require("closed: a piston with half_length = 0 has no rear corners; close the front ones")
def closes_its_own(x: Any, u: Any, p: Any, numbers: Vector) -> bool:
    return has_its_closed_corners(x, p)


@kernel
def can_touch_together(x: Any) -> bool:
    """True unless two corners across from each other are closed."""
    return x.closed[0] * x.closed[2] == 0.0 and x.closed[1] * x.closed[3] == 0.0


@require(
    "closed: {word} cannot touch together; close one corner, two on one wall, or a diagonal",
    words=NAMES_TOGETHER,
)
def closes_together(x: Any, u: Any, p: Any, numbers: Vector) -> bool:
    numbers[0] = encode_closed_corners(x)
    return can_touch_together(x) or not has_its_closed_corners(x, p)


@require(
    "offset = {1:g} m, tilt = {2:g} rad: the {word} corner starts {3:g} m outside its wall; bring the "
    "piston inside its clearance of {4:g} m",
    words=NAMES,
)
def starts_between_walls(x: Any, u: Any, p: Any, numbers: Vector) -> bool:
    """Reports the first open corner outside its wall, if the closed corners are possible."""
    if not has_its_closed_corners(x, p) or not can_touch_together(x):
        return True
    numbers[1], numbers[2], numbers[4] = x.offset, x.tilt, p.clearance
    for i in range(CORNERS):
        beyond = -gap(i, x.offset, x.tilt, p)
        if x.closed[i] == 0.0 and beyond > ROUNDING * p.clearance:
            numbers[0], numbers[3] = i, beyond
            return False
    return True


REQUIREMENTS = (crank_turns, piston_stays_upright)
START_REQUIREMENTS = (closes_its_own, closes_together, starts_between_walls)
