"""Contact of a cam with flat and translating followers and with fingers about an end pivot, for a lift."""

import math
from typing import NamedTuple

from ...compile.kernel import kernel
from ..cams.lift import Lift
from .arc import ArcMotion, CamContact, touch_arc


class Flat(NamedTuple):
    """Base circle radius of the cam (m), and tilt of the face (rad): that of its normal from y towards x."""

    base_radius: float
    tilt: float = 0.0


@kernel
def touch_flat(cam: Lift, g: Flat) -> CamContact:
    """The face is p = R0 + s cos(tilt) off the axis, the contact p' beside it; rho = p + p''."""
    n_x, n_y = math.sin(g.tilt), math.cos(g.tilt)
    distance, aside, bend = g.base_radius + cam.s * n_y, cam.ds * n_y, cam.dds * n_y
    x, y = distance * n_x + aside * n_y, distance * n_y - aside * n_x
    radius = distance + bend
    return CamContact(x, y, n_x, n_y, aside, radius, radius, bend + cam.ds * n_x, 0.0)


class Translating(NamedTuple):
    """Base circle radius of the cam, radius of the roller or pad, offset of its path from the axis (m)."""

    base_radius: float
    radius: float
    offset: float


@kernel
def move_translating(cam: Lift, g: Translating) -> ArcMotion:
    """The centre at (e, Y), Y = sqrt((R0 + r)^2 - e^2) + s."""
    pitch = g.base_radius + g.radius
    y = math.sqrt(pitch * pitch - g.offset * g.offset) + cam.s
    return ArcMotion(g.offset, y, 0.0, cam.ds, 0.0, cam.dds, 0.0)


@kernel
def touch_translating(cam: Lift, g: Translating) -> CamContact:
    return touch_arc(move_translating(cam, g), g.radius)


class Finger(NamedTuple):
    """A finger on its end pivot.

    Base circle radius of the cam; radius of the roller or pad; distance from the pivot to the centre of the
    arc (m); angle by which that line falls from the pivot, valve closed (rad); distance from the pivot to
    the centre of the pad on the valve (m); angle by which that line falls further (rad). The cam's surface
    moves towards the pivot; negative distances put the pivot on the other side.
    """

    base_radius: float
    radius: float
    cam_arm: float
    pivot_angle: float
    valve_arm: float
    valve_angle: float


@kernel
def turn_finger(cam: Lift, g: Finger) -> Lift:
    """Rotation of the finger (rad) with its derivatives, for a lift of the valve.

    s = L_v (sin(beta - alpha) + sin(alpha)), as the tip of the valve is flat and normal to y.
    """
    closed = g.pivot_angle + g.valve_angle
    sine = cam.s / g.valve_arm - math.sin(closed)
    cosine = math.sqrt(1.0 - sine * sine)
    rate = cam.ds / (g.valve_arm * cosine)
    return Lift(
        closed + math.asin(sine), rate, cam.dds / (g.valve_arm * cosine) + sine / cosine * rate * rate
    )


@kernel
def move_finger(cam: Lift, g: Finger) -> ArcMotion:
    """The centre on its circle about the pivot; valve closed it is at (0, R0 + r)."""
    beta = turn_finger(cam, g)
    angle = beta.s - g.pivot_angle
    x, y = g.cam_arm * math.cos(angle), g.cam_arm * math.sin(angle)
    pivot_x = -g.cam_arm * math.cos(g.pivot_angle)
    pivot_y = g.base_radius + g.radius + g.cam_arm * math.sin(g.pivot_angle)
    square = beta.ds * beta.ds
    return ArcMotion(
        pivot_x + x,
        pivot_y + y,
        -y * beta.ds,
        x * beta.ds,
        -y * beta.dds - x * square,
        x * beta.dds - y * square,
        beta.ds,
    )


@kernel
def touch_finger(cam: Lift, g: Finger) -> CamContact:
    return touch_arc(move_finger(cam, g), g.radius)
