"""Contact of a cam with a follower whose surface is a circular arc: a roller, or a pad fixed to its body.

The cam turns about the origin, anticlockwise by the cam angle; its follower lies in the direction of y. A
prime is d/d(cam angle). The arc's centre moves as the cam's pitch curve asks.
"""

import math
from typing import NamedTuple

from ...compile.kernel import kernel


class ArcMotion(NamedTuple):
    """Centre (x, y) of the arc (m) with two derivatives, and the rotation rate of its body, anticlockwise."""

    x: float
    y: float
    dx: float
    dy: float
    ddx: float
    ddy: float
    turn: float


class CamContact(NamedTuple):
    """Where a cam touches its follower.

    `x`, `y`: the point (m). `normal_x`, `normal_y`: unit normal out of the cam. `arm`: of the load about the
    cam's axis (m): the torque against the rotation is load * arm. `radius`: of curvature of the cam (m,
    negative where hollow). `cam_rate`, `follower_rate`: distances by which the contact moves along both
    surfaces, per cam angle (m). `normal_turn`: turning rate of the normal, clockwise.
    """

    x: float
    y: float
    normal_x: float
    normal_y: float
    arm: float
    radius: float
    cam_rate: float
    follower_rate: float
    normal_turn: float


@kernel
def touch_arc(m: ArcMotion, radius: float) -> CamContact:
    """The contact of the cam that moves the centre of an arc of this radius so.

    In the cam's frame the centre has the velocity v = C' - z x C and the acceleration
    a = C'' - 2 z x C' - C; the pitch curve's radius of curvature is -|v|^3 / (v x a).
    """
    vx, vy = m.dx + m.y, m.dy - m.x
    ax, ay = m.ddx + 2.0 * m.dy - m.x, m.ddy - 2.0 * m.dx - m.y
    speed = math.sqrt(vx * vx + vy * vy)
    normal_x, normal_y = -vy / speed, vx / speed
    # Turning rate of the normal in the cam's frame: |v| over the pitch curve's radius.
    turn = (vy * ax - vx * ay) / (speed * speed)
    cam_rate = speed - radius * turn
    return CamContact(
        m.x - radius * normal_x,
        m.y - radius * normal_y,
        normal_x,
        normal_y,
        normal_x * m.dx + normal_y * m.dy,
        cam_rate / turn,
        cam_rate,
        -radius * (turn - 1.0 + m.turn),
        turn - 1.0,
    )
