"""Valve trains, drawn: direct, with tappet, pushrod and rocker, with finger."""

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from models.core import roles
from models.core.quantities import Vector
from models.core.roles import CoilSpring
from models.valve_train.followers.shape import sample_angles, trace_shape

from ..scenario.cams import read_cam
from ..scenario.component_table import ComponentTable
from .sketch import CIRCLE, GROUND, MM, Parts, Sketch

# Points of a cam's contour.
CONTOUR = 240
# Thickness of a bucket's plate (mm).
PLATE = 3.0


def draw_cam(sketch: Sketch, parts: Parts, name: str, angle: str) -> float:
    """The contour of a cam about the origin, and the width of the follower (mm) that it needs."""
    x, y = trace_contour(parts.tables[name])
    cam = sketch.frame(turn=[(angle, 1.0)])
    sketch.polygon("cam", cam, [(MM * a, MM * b) for a, b in zip(x, y, strict=True)], f"cam of {name}")
    sketch.circle("pin", cam, 0.0, 0.0, 0.3 * MM * float(np.min(np.hypot(x, y))), "shaft")
    sketch.draw("mark", [(cam, 0.0, 0.0), (cam, MM * float(x[0]), MM * float(y[0]))], closed=False)
    return 2.2 * MM * float(np.max(np.hypot(x, y)) - np.min(np.hypot(x, y))) + 18.0


def trace_contour(table: ComponentTable) -> tuple[Vector, Vector]:
    """The contour of a component's cam (m), at the cam angle zero."""
    cam = read_cam(table)
    shape = trace_shape(sample_angles(CONTOUR), cam.lift, cam.follower, cam.geometry)
    return shape.x, shape.y


def draw_pad(sketch: Sketch, moving: int, centre: float, radius: float, top: float, title: str) -> None:
    """The arc of a pad that slides on the cam, about a point above it, and its foot on the lever at `top`."""
    half = min(0.7, 13.0 / radius)
    angles = np.linspace(-half, half, CIRCLE // 2)
    arc = [(radius * math.sin(a), centre - radius * math.cos(a)) for a in angles]
    sketch.polygon("body", moving, [*arc, (7.0, top), (-7.0, top)], title)


def draw_bucket(sketch: Sketch, moving: int, bottom: float, width: float, title: str) -> None:
    sketch.box("body", moving, 0.0, bottom, width, PLATE, title)
    for side in (-1.0, 1.0):
        sketch.box("body", moving, side * (0.5 * width - 1.2), bottom + PLATE, 2.4, 12.0, title)


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
    moved = [*parts.list_driven(f"{valve}.position"), *parts.list_driven(f"{valve}.valve_lift")]
    springs += [name for name in moved if parts.has_role(name, CoilSpring)]
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


def sketch_direct(parts: Parts, cam: str) -> Sketch | None:
    """A camshaft's cam on the flat follower of a valve."""
    contact = next(iter(parts.list_driven(f"{cam}.entraining_velocity")), "")
    valve = parts.driver(f"{contact}.retreat")
    if not parts.has(f"{valve}.position") or not parts.has(f"{cam}.cam_angle"):
        return None
    sketch = Sketch(f"valve train of {cam}", mirrored=True)
    width = draw_cam(sketch, parts, cam, f"{cam}.cam_angle")
    top = MM * parts.numbers(cam)["base_radius"]
    moving = sketch.frame(shift=[(f"{valve}.position", 0.0, MM)])
    draw_bucket(sketch, moving, top, width, valve)
    draw_valve(sketch, parts, valve, 0.0, top + 3.0)
    _add_contacts(sketch, parts, [contact])
    return sketch


def sketch_tappet(parts: Parts, tappet: str) -> Sketch | None:
    """A cam on a tappet, and what the tappet moves: a pushrod with rocker, or a valve."""
    if not (parts.has(f"{tappet}.position") and parts.has(f"{tappet}.profile_angle")):
        return None
    above = parts.driver(f"{tappet}.load")
    rod = above if parts.has_role(above, roles.Rod) else ""
    rocker = parts.driver(f"{rod}.upper_position") if rod else ""
    sketch = Sketch(f"valve train of {tappet}", mirrored=not parts.has_role(rocker, roles.Rocker))
    p = parts.numbers(tappet)
    follower = ("flat", "roller", "pad")[int(p["follower"])]
    width = draw_cam(sketch, parts, tappet, f"{tappet}.profile_angle")
    base, radius, offset = MM * p["base_radius"], MM * p["follower_radius"], MM * p["offset"]
    moving = sketch.frame(shift=[(f"{tappet}.position", 0.0, MM)])
    contacts = parts.list_driven(f"{tappet}.entraining_velocity")
    if follower == "flat":
        top, seat = base, base + PLATE
        draw_bucket(sketch, moving, base, width, tappet)
    else:
        centre = math.sqrt((base + radius) ** 2 - offset**2)
        sketch.circle("roller" if follower == "roller" else "body", moving, offset, centre, radius, tappet)
        top, seat = centre + radius, centre + radius + 8.0
        sketch.box("body", moving, offset, centre, 1.2 * radius, radius + 8.0, tappet)
    if parts.has_role(rocker, roles.Rocker):
        contacts += _draw_rocker(sketch, parts, rocker, rod, moving, offset, seat)
    else:
        # A tappet that springs act on directly is one body with its valve.
        valve = tappet if parts.has_role(above, roles.CoilSpring) else find_valve(parts, above)
        if not valve:
            return None
        if parts.has_role(above, roles.Adjuster):
            sketch.box("adjuster", moving, offset, top + 3.0, 9.0, 9.0, above)
            top += 9.0
        draw_valve(sketch, parts, valve, offset, top + 3.0)
    _add_contacts(sketch, parts, contacts)
    return sketch


def sketch_finger(parts: Parts, finger: str) -> Sketch | None:
    """A cam on a finger that turns about its end and opens a valve."""
    contacts = parts.list_driven(f"{finger}.entraining_velocity")
    tips = parts.list_driven(f"{finger}.tip_entraining_velocity")
    valve = next(filter(None, (find_valve(parts, tip) for tip in tips)), "")
    if not (valve and parts.has(f"{finger}.rotation") and parts.has(f"{finger}.profile_angle")):
        return None
    sketch = Sketch(f"valve train of {finger}", mirrored=True)
    p = parts.numbers(finger)
    draw_cam(sketch, parts, finger, f"{finger}.profile_angle")
    base, radius, arm = MM * p["base_radius"], MM * p["follower_radius"], MM * p["cam_arm"]
    x = -arm * math.cos(p["pivot_angle"])
    y = base + radius + arm * math.sin(p["pivot_angle"])
    shift = [(f"{finger}.pivot_position", 0.0, MM)] if parts.has(f"{finger}.pivot_position") else []
    moving = sketch.frame(turn=[(f"{finger}.rotation", 1.0)], about=(x, y), shift=shift)
    tip_angle = -p["pivot_angle"] - p["valve_angle"]
    tip = x + MM * p["valve_arm"] * math.cos(tip_angle), y + MM * p["valve_arm"] * math.sin(tip_angle)
    pad = MM * p["tip_radius"]
    back = tip[1] + 0.45 * pad
    under = [(x, y - 5.0), (0.0, back - 7.0), (tip[0], back - 6.0)]
    over = [(tip[0], back), (0.0, back + 1.0), (x, y + 5.0)]
    sketch.polygon("body", moving, under + over, finger)
    sketch.circle("body", moving, tip[0], tip[1] + 0.55 * pad, 0.45 * pad, finger)
    if p["rolls"]:
        sketch.circle("roller", moving, 0.0, base + radius, radius, finger)
    else:
        draw_pad(sketch, moving, base + radius, radius, back - 3.0, finger)
    sketch.circle("pin", moving, x, y, 3.0, "pivot")
    adjuster = parts.driver(f"{finger}.pivot_force")
    ground = GROUND
    if adjuster:
        ground = sketch.frame(shift=shift)
        sketch.box("adjuster", ground, x, y, 10.0, 22.0, adjuster)
    sketch.box("ground", GROUND, x, y + (14.0 if adjuster else 4.0), 16.0, 20.0, "head")
    draw_valve(sketch, parts, valve, tip[0], tip[1] + pad)
    _add_contacts(sketch, parts, contacts + tips)
    return sketch


def _draw_rocker(
    sketch: Sketch, parts: Parts, rocker: str, rod: str, tappet: int, x: float, y: float
) -> list[str]:
    """A pushrod from (x, y) on the tappet, the rocker on it and the valve; the contacts on the valve."""
    p = parts.numbers(rocker)
    length = min(MM * parts.numbers(rod).get("length", 0.1), 90.0)
    arm, fall = MM * p["rod_arm"], p["rod_angle"]
    end = y + length
    pivot = x + arm * math.cos(fall), end + arm * math.sin(fall)
    moving = sketch.frame(turn=[(f"{rocker}.rotation", -1.0)], about=pivot)
    sketch.draw("link", [(tappet, x, y), (moving, x, end)], rod, closed=False)
    reach = MM * p["valve_arm"]
    tip = pivot[0] + reach * math.cos(p["valve_angle"]), pivot[1] - reach * math.sin(p["valve_angle"])
    under = [(x, end - 3.0), _add(pivot, 0.0, -8.0), _add(tip, 0.0, -4.0)]
    over = [_add(tip, 5.0, 2.0), _add(pivot, 0.0, 8.0), (x - 4.0, end + 3.0)]
    sketch.polygon("body", moving, under + over, rocker)
    sketch.circle("pin", GROUND, *pivot, 4.0, "pivot")
    contacts = parts.list_driven(f"{rocker}.tip_entraining_velocity")
    valve = next(filter(None, (find_valve(parts, one) for one in contacts or [rocker])), "")
    if valve:
        draw_valve_below(sketch, parts, valve, *_add(tip, 0.0, -4.0))
    return contacts


def _add(point: tuple[float, float], x: float, y: float) -> tuple[float, float]:
    return point[0] + x, point[1] + y


def _add_contacts(sketch: Sketch, parts: Parts, contacts: Sequence[str]) -> None:
    """The contacts whose films the page shows enlarged."""
    for contact in dict.fromkeys(contacts):
        wanted = ("load", "film_thickness", "half_width", "maximum_pressure")
        if all(parts.has(f"{contact}.{name}") for name in wanted):
            found = {name: f"{contact}.{name}" for name in wanted}
            radius = parts.sources.get(f"{contact}.radius_of_curvature", "")
            if parts.has(radius):
                found["radius"] = radius
            for end in ("approach", "retreat"):  # their distance is the gap of a contact without load
                if parts.has(source := parts.sources.get(f"{contact}.{end}", "")):
                    found[end] = source
            sketch.contacts.append({"title": contact, "variables": found})
            sketch.variables |= set(found.values())
