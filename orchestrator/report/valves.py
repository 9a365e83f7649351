"""Valves with their springs and seats, drawn."""

from typing import Any

import numpy as np

from models.core.roles import CoilSpring

from .sketch import GROUND, MM, Parts, Sketch

# Turns of a spring, and its half width (mm).
TURNS, COIL = 7, 11.0


def find_valve(parts: Parts, start: str) -> str:
    """The nearest instance with a valve lift that `start` gives its output to."""
    waiting, seen = [start], {start}
    while waiting:
        at = waiting.pop(0)
        if parts.has(f"{at}.valve_lift") and parts.has(f"{at}.position"):
            return at
        for target, source in parts.sources.items():
            name = target.split(".")[0]
            if source.split(".")[0] == at and name not in seen:
                seen.add(name)
                waiting.append(name)
    return ""


def draw_valve(sketch: Sketch, parts: Parts, valve: str, x: float, y: float) -> None:
    """A valve that opens along y from its tip at (x, y), with its springs and its seat."""
    moving = sketch.frame(shift=[(f"{valve}.position", 0.0, MM)])
    plate, length, head = y + 42.0, 78.0, 15.0
    end = y + length
    right = [(2.5, y), (2.5, end - 8.0), (head, end), (head, end + 2.5)]
    left = [(-across, at) for across, at in reversed(right)]
    sketch.polygon("body", moving, [(x + across, at) for across, at in right + left], valve)
    sketch.box("body", moving, x, y + 3.0, 2.0 * COIL + 8.0, 3.0, "retainer")
    for side in (-1.0, 1.0):
        port = [
            (3.5, plate),
            (30.0, plate),
            (30.0, end + 1.5),
            (head + 1.5, end + 1.5),
            (head - 3.0, end - 3.0),
        ]
        corners = [(x + side * across, at) for across, at in [*port, (3.5, end - 14.0)]]
        sketch.polygon("ground", GROUND, corners, "head")
    springs = [valve] if parts.has(f"{valve}.coil_position[1]") else []
    springs += [name for name in parts.list_driven(f"{valve}.position") if parts.has_role(name, CoilSpring)]
    for number, spring in enumerate(springs):
        _draw_spring(sketch, parts, spring, moving, (x, y + 6.0), plate, COIL - 4.0 * number)


def _draw_spring(
    sketch: Sketch,
    parts: Parts,
    spring: str,
    moving: int,
    top: tuple[float, float],
    plate: float,
    half: float,
) -> None:
    """A zigzag from the moving end over the coil masses to the plate: turns close up where a surge runs."""
    count = 0
    while parts.has(f"{spring}.coil_position[{count + 1}]"):
        count += 1
    masses = [sketch.frame(shift=[(f"{spring}.coil_position[{i + 1}]", 0.0, MM)]) for i in range(count)]
    # The ends are half a segment off the first and the last mass.
    frames, places = [moving, *masses, GROUND], [0.0, *((i + 0.5) / count for i in range(count)), 1.0]
    nodes: list[Any] = []
    for k in range(2 * TURNS + 1):
        share = k / (2 * TURNS)
        i = min(int(np.searchsorted(places, share, side="right")) - 1, len(places) - 2)
        between = (share - places[i]) / (places[i + 1] - places[i])
        x = top[0] + (half if k % 2 else -half)
        nodes.append((frames[i], frames[i + 1], between, x, top[1] + share * (plate - top[1])))
    sketch.draw("spring", nodes, spring, closed=False)
    for frame, place in zip(masses, places[1:-1], strict=True):
        sketch.circle("mass", frame, top[0] + half + 4.0, top[1] + place * (plate - top[1]), 1.6, "coil mass")


def draw_valve_below(sketch: Sketch, parts: Parts, valve: str, x: float, y: float) -> None:
    """A valve that opens against y: drawn as the others, upside down."""
    other = Sketch("")
    draw_valve(other, parts, valve, x, 0.0)
    first = len(sketch.frames)
    for frame in other.frames[1:]:
        turned = [(name, fx, -fy) for name, fx, fy in frame["shift"]]
        sketch.frame(shift=turned)

    def renumber(frame: int) -> int:
        return frame and frame + first - 1

    for shape in other.shapes:
        nodes = [
            (renumber(n[0]), n[1], y - n[2])
            if len(n) == 3
            else (renumber(n[0]), renumber(n[1]), n[2], n[3], y - n[4])
            for n in shape["nodes"]
        ]
        sketch.draw(shape["kind"], nodes, shape["title"], shape["closed"])
