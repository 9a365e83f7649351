"""Scalar constraints C(q, t) = 0 of which joints are made, each with its row of the Jacobian and its gamma.

Haug (1989), Computer Aided Kinematics and Dynamics of Mechanical Systems I, section 9.4. d = P_j - P_i.
gamma holds the terms of -C'' without accelerations, so that J v' = gamma.
"""

import math
from typing import Any, NamedTuple

from ..compile.kernel import kernel
from ..valve_train.cams.lift import Lift
from .tables import AHEAD, DRIVEN, LEVER, PERPENDICULAR, Evaluation, Rows
from .vectors import Arrow, add, cross, dot, pick, scale, subtract, to_ground


class Moving(NamedTuple):
    """A vector with its rate, and its second rate without angular accelerations."""

    value: Arrow
    rate: Arrow
    second: Arrow


class Curve(NamedTuple):
    """Support function R0 + s(psi) of a cam or a lever's end."""

    base_radius: float
    lift: Lift


@kernel
def carry(e: Evaluation, body: int, a: Any) -> Moving:
    """A vector that is fixed in the body."""
    value, omega = to_ground(e.rotation[body], pick(a)), pick(e.omega[body])
    rate = cross(omega, value)
    return Moving(value, rate, cross(omega, rate))


@kernel
def point_at(e: Evaluation, body: int, arm: Moving) -> Moving:
    """The point at the end of that arm from the body's centre of mass."""
    return Moving(add(pick(e.position[body]), arm.value), add(pick(e.velocity[body]), arm.rate), arm.second)


@kernel
def differ(b: Moving, a: Moving) -> Moving:
    return Moving(subtract(b.value, a.value), subtract(b.rate, a.rate), subtract(b.second, a.second))


@kernel
def rate_of_product(a: Moving, b: Moving) -> float:
    return dot(a.rate, b.value) + dot(a.value, b.rate)


@kernel
def second_of_product(a: Moving, b: Moving) -> float:
    return dot(a.second, b.value) + 2.0 * dot(a.rate, b.rate) + dot(a.value, b.second)


@kernel
def put(out: Rows, k: int, side: int, force: Arrow, moment: Arrow) -> None:
    """The row k of the Jacobian at the velocity and angular velocity of i (side 0) or j (side 1)."""
    row = out.entries[k, side]
    row[0], row[1], row[2] = force.x, force.y, force.z
    row[3], row[4], row[5] = moment.x, moment.y, moment.z


@kernel
def keep_perpendicular(e: Evaluation, out: Rows, k: int, row: Any) -> None:
    """C = a b."""
    a, b = carry(e, row.i, row.a), carry(e, row.j, row.b)
    moment, none = cross(a.value, b.value), Arrow(0.0, 0.0, 0.0)
    put(out, k, 0, none, moment)
    put(out, k, 1, none, scale(-1.0, moment))
    out.value[k] = dot(a.value, b.value)
    out.gamma[k] = -second_of_product(a, b)


@kernel
def drive(t: float, e: Evaluation, out: Rows, k: int, row: Any) -> None:
    """C = a(t) b = sin(phi - theta): j turns to the angle phi = phi0 + phi0' t + phi0'' t^2/2 against i.

    a = a1 sin(phi) - a2 cos(phi) with two axes of i, b the first axis of j. The multiplier is the torque of
    the drive.
    """
    angle = row.angle + (row.speed + 0.5 * row.acceleration * t) * t
    speed = row.speed + row.acceleration * t
    c, s = math.cos(angle), math.sin(angle)
    first, second, b = carry(e, row.i, row.a), carry(e, row.i, row.a2), carry(e, row.j, row.b)
    a = subtract(scale(s, first.value), scale(c, second.value))
    turned = add(scale(s, second.value), scale(c, first.value))  # da/dphi; d2a/dphi2 = -a
    own = subtract(scale(s, first.rate), scale(c, second.rate))
    own_second = subtract(scale(s, first.second), scale(c, second.second))
    turned_rate = add(scale(s, second.rate), scale(c, first.rate))
    total = Moving(
        a,
        add(own, scale(speed, turned)),
        add(
            add(own_second, scale(2.0 * speed, turned_rate)),
            subtract(scale(row.acceleration, turned), scale(speed * speed, a)),
        ),
    )
    moment, none = cross(a, b.value), Arrow(0.0, 0.0, 0.0)
    put(out, k, 0, none, moment)
    put(out, k, 1, none, scale(-1.0, moment))
    out.value[k] = dot(a, b.value)
    out.rate[k] = speed * dot(turned, b.value)
    out.gamma[k] = -second_of_product(total, b)


@kernel
def keep_ahead(e: Evaluation, out: Rows, k: int, row: Any) -> None:
    """C = a d - offset."""
    a = carry(e, row.i, row.a)
    arm_i, arm_j = carry(e, row.i, row.p_i), carry(e, row.j, row.p_j)
    d = differ(point_at(e, row.j, arm_j), point_at(e, row.i, arm_i))
    put(out, k, 0, scale(-1.0, a.value), cross(a.value, add(d.value, arm_i.value)))
    put(out, k, 1, a.value, cross(arm_j.value, a.value))
    out.value[k] = dot(a.value, d.value) - row.offset
    out.gamma[k] = -second_of_product(a, d)


@kernel
def find_cam_angle(e: Evaluation, row: Any) -> float:
    """psi from the face's normal n, fixed in j, to the cam's axis a: cos(psi) = n a, sin(psi) = -n a2.

    It holds the follower's tilt.
    """
    n = carry(e, row.j, row.b).value
    return math.atan2(-dot(n, carry(e, row.i, row.a2).value), dot(n, carry(e, row.i, row.a).value))


@kernel
def follow_cam(e: Evaluation, out: Rows, k: int, row: Any, curve: Curve) -> float:
    """C = R0 + s(psi) - n d: a flat face with normal n, fixed in j, on the cam i with its centre at P_i.

    Kushwaha et al. 2000, section 4.1, with a contact condition in place of (27) and (30). The multiplier is
    the contact load W. Returns psi', the speed of the cam against the face.
    """
    n, first, second = carry(e, row.j, row.b), carry(e, row.i, row.a), carry(e, row.i, row.a2)
    arm_i, arm_j = carry(e, row.i, row.p_i), carry(e, row.j, row.p_j)
    d = differ(point_at(e, row.j, arm_j), point_at(e, row.i, arm_i))
    c, s = dot(n.value, first.value), -dot(n.value, second.value)
    c_rate, s_rate = rate_of_product(n, first), -rate_of_product(n, second)
    square = c * c + s * s
    turning = (c * s_rate - s * c_rate) / square
    bent = -c * second_of_product(n, second) - s * second_of_product(n, first)
    bent = (bent - 2.0 * turning * (c * c_rate + s * s_rate)) / square
    # psi' = g (omega_i - omega_j).
    g = add(scale(c, cross(n.value, second.value)), scale(s, cross(n.value, first.value)))
    lever = scale(curve.lift.ds / square, g)
    put(out, k, 0, n.value, subtract(lever, cross(n.value, arm_i.value)))
    back = cross(n.value, subtract(d.value, arm_j.value))
    put(out, k, 1, scale(-1.0, n.value), scale(-1.0, add(lever, back)))
    out.value[k] = curve.base_radius + curve.lift.s - dot(n.value, d.value)
    out.gamma[k] = second_of_product(n, d) - curve.lift.dds * turning * turning - curve.lift.ds * bent
    return turning


@kernel
def lift_end(psi: float, row: Any) -> Lift:
    """s(psi) of a lever's end: an involute, which keeps its lever ratio, or a round pad at the end of an arm.

    Involute: a cos(b) psi. Pad: a (sin(psi - b) + sin(b)), its centre at the distance a from the pivot.
    """
    if row.kind == LEVER:
        arm = row.arm * math.cos(row.tilt)
        return Lift(arm * psi, arm, 0.0)
    along, across = row.arm * math.cos(psi - row.tilt), row.arm * math.sin(psi - row.tilt)
    return Lift(across + row.arm * math.sin(row.tilt), along, -across)


@kernel
def constrain(t: float, e: Evaluation, out: Rows, k: int, row: Any) -> None:
    """Fill the row k, of a joint without a curve."""
    if row.kind == AHEAD:
        keep_ahead(e, out, k, row)
    elif row.kind == DRIVEN:
        drive(t, e, out, k, row)
    elif row.kind == PERPENDICULAR:
        keep_perpendicular(e, out, k, row)
