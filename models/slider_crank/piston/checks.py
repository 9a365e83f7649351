"""What ranges alone cannot say about parameters and start of the slider-crank with a tilting piston."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

from .contact import CORNERS, exists, gap
from .motion import machine

NAMES = ("upper front", "upper rear", "lower front", "lower rear")
# A corner may start this share of the clearance outside its wall: room for rounding of given numbers.
ROUNDING = 1e-9


def check(p: Any) -> Sequence[str]:
    """Messages for parameters that do not fit together."""
    found = []
    # The largest offset of the pin: the piston in a corner of its play.
    play = p.clearance + abs(p.pin_offset) + abs(p.pin_height)
    if p.crank_radius + play >= p.rod_length:
        found.append(
            f"crank_radius = {p.crank_radius:g} m: must be less than {p.rod_length - play:g} m, the "
            "rod_length less clearance and place of the pin, or the crank cannot turn"
        )
    least = math.sqrt(p.clearance * (2.0 * p.half_height + p.clearance))
    if 0.0 < p.half_length <= least:
        found.append(
            f"half_length = {p.half_length:g} m: must be more than {least:g} m for this half_height and "
            "clearance, or the piston can turn over in its bore; 0 makes it a roller"
        )
    return found


def check_start(p: Any, x: Any, u: Any) -> Sequence[str]:
    """Messages for a start outside the walls, or with corners closed that cannot be."""
    m = machine(p)
    shut = [i for i in range(CORNERS) if x.closed[i] != 0.0]
    if any(not exists(i, m) for i in shut):
        return ["closed: a piston with half_length = 0 has no rear corners; close the front ones"]
    if len(shut) > 2 or (len(shut) == 2 and shut[1] - shut[0] == 2):
        closed = " and ".join(NAMES[i] for i in shut)
        return [f"closed: {closed} cannot touch together; close one corner, two on one wall, or a diagonal"]
    for i in range(CORNERS):
        beyond = -gap(i, x.offset, x.tilt, m)
        if i not in shut and beyond > ROUNDING * m.clearance:
            return [
                f"offset = {x.offset:g} m, tilt = {x.tilt:g} rad: the {NAMES[i]} corner starts {beyond:g} m "
                f"outside its wall; bring the piston inside its clearance of {m.clearance:g} m"
            ]
    return []
