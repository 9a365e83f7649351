"""Valve trains, drawn: direct, with tappet, pushrod and rocker, with finger."""

import math
from collections.abc import Sequence

from models.core import roles

from .cams import PLATE, draw_bucket, draw_cam, draw_pad
from .sketch import GROUND, MM, Parts, Sketch
from .valves import draw_valve, draw_valve_below, find_valve


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
