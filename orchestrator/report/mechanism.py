"""The mechanisms of a scenario, as drawings that its results move."""

import math
from collections.abc import Callable, Mapping, Sequence

from models.core import roles

from ..scenario import Scenario
from .sketch import GROUND, MM, Parts, Sketch
from .trains import sketch_direct, sketch_finger, sketch_tappet

# A play between walls is drawn this wide (mm).
PLAY = 6.0


def sketch_slider_crank(parts: Parts, name: str) -> Sketch | None:
    """A slider-crank whose roller has play between the walls; the play is drawn wider than it is."""
    p = parts.numbers(name)
    play = p["clearance"]
    return _sketch_crank(parts, name, PLAY / (MM * play) if play > 0.0 else 1.0, MM * play, "")


def sketch_piston_crank(parts: Parts, name: str) -> Sketch | None:
    """A piston that tilts between its walls; play and tilt are drawn larger than they are."""
    p = parts.numbers(name)
    return _sketch_crank(parts, name, PLAY / (MM * p["clearance"]), MM * p["half_height"], "tilting")


def _sketch_crank(parts: Parts, name: str, scale: float, half: float, tilting: str) -> Sketch | None:
    angle = parts.sources.get(f"{name}.crank_angle", "")
    if not (parts.has(angle) and parts.has(f"{name}.piston_position") and parts.has(f"{name}.piston_offset")):
        return None
    p = parts.numbers(name)
    radius, length = MM * p["crank_radius"], MM * p["rod_length"]
    sketch = Sketch(f"{name} (play {scale:.3g} times as wide)")
    crank = sketch.frame(turn=[(angle, 1.0)])
    shift = [(f"{name}.piston_position", MM, 0.0), (f"{name}.piston_offset", 0.0, scale * MM)]
    turn = [(f"{name}.piston_tilt", scale)] if tilting and parts.has(f"{name}.piston_tilt") else []
    piston = sketch.frame(turn=turn, shift=shift)
    if tilting:
        high, long = half, MM * p["half_length"]
    else:
        high = long = min(MM * p["roller_radius"], 0.45 * radius)
    wall = high + PLAY
    begin, end = length - radius - 2.0 * long, length + radius + 2.0 * long
    for side, word, numbers in ((wall, "upper", (1, 2)), (-wall, "lower", (3, 4))):
        other = side + math.copysign(6.0, side)
        corners = [(begin, side), (end, side), (end, other), (begin, other)]
        sketch.polygon("ground", GROUND, corners, f"{word} wall")
        forces = [f"{name}.{word}_{place}force" for place in ("wall_", "front_", "rear_")]
        counters = [f"{name}.{word}_impact_count", *(f"{name}.corner_impact_count[{i}]" for i in numbers)]
        sketch.light(list(filter(parts.has, forces)), list(filter(parts.has, counters)))
    sketch.circle("body", crank, 0.0, 0.0, 0.35 * radius, "crank")
    sketch.draw("link", [(crank, 0.0, 0.0), (crank, radius, 0.0)], "crank", closed=False)
    sketch.draw("link", [(crank, radius, 0.0), (piston, 0.0, 0.0)], "connecting rod", closed=False)
    if tilting:
        sketch.box("body", piston, 0.0, -high, 2.0 * long, 2.0 * high, name)
    else:
        sketch.circle("roller", piston, 0.0, 0.0, high, name)
    for frame, x in ((crank, 0.0), (crank, radius), (piston, 0.0)):
        sketch.circle("pin", frame, x, 0.0, 2.5)
    return sketch


# By the role of the part that a drawing begins with.
SKETCHES: Mapping[type[roles.Role], Callable[[Parts, str], Sketch | None]] = {
    roles.FlatFollower: sketch_direct,
    roles.TranslatingFollower: sketch_tappet,
    roles.PivotedFollower: sketch_finger,
    roles.Crank: sketch_slider_crank,
    roles.PistonCrank: sketch_piston_crank,
}


def list_sketches(scenario: Scenario, known: Sequence[str]) -> list[Sketch]:
    """The sketches of all mechanisms that are known here."""
    parts = Parts(scenario, known)
    found = [draw(parts, name) for role, draw in SKETCHES.items() for name in parts.list_role(role)]
    return [sketch for sketch in found if sketch is not None]
