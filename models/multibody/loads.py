"""Force elements: springs and dampers, contacts with and without an oil film, elastic fields."""

import math
from typing import Any, NamedTuple

from ..compile.kernel import kernel
from ..contact.ehl_contact import contact
from .constraints import Curve, carry, differ, point_at
from .tables import Evaluation
from .vectors import Arrow, add, cross, dot, pick, scale, subtract, to_body, to_ground


@kernel
def push(e: Evaluation, body: int, force: Arrow, moment: Arrow) -> None:
    """Add a force at the body's centre of mass and a moment, both in the axes of the ground."""
    if body > 0:
        f, c = e.force, 6 * (body - 1)
        f[c] += force.x
        f[c + 1] += force.y
        f[c + 2] += force.z
        f[c + 3] += moment.x
        f[c + 4] += moment.y
        f[c + 5] += moment.z


@kernel
def load_spring(e: Evaluation, s: Any) -> None:
    """F = -k (L - L0) - c L' along the line from P_i to P_j; positive drives the points apart."""
    arm_i, arm_j = carry(e, s.i, s.at_i), carry(e, s.j, s.at_j)
    d = differ(point_at(e, s.j, arm_j), point_at(e, s.i, arm_i))
    length = math.sqrt(dot(d.value, d.value))
    direction = scale(1.0 / length, d.value)
    force = scale(-s.stiffness * (length - s.length) - s.damping * dot(direction, d.rate), direction)
    push(e, s.j, force, cross(arm_j.value, force))
    back = scale(-1.0, force)
    push(e, s.i, back, cross(arm_i.value, back))


@kernel
def close(e: Evaluation, k: int) -> float:
    """Rate of the overlap of the contact k."""
    rate = 0.0
    for side in range(2):
        body = e.touch.bodies[k, side]
        for i in range(3):
            rate += e.touch.entries[k, side, i] * e.velocity[body, i]
            rate += e.touch.entries[k, side, 3 + i] * e.omega[body, i]
    return rate


@kernel
def push_apart(e: Evaluation, k: int, load: float) -> None:
    """f = -J^T W of the contact k."""
    e.load[k] = load
    for side in range(2):
        along, about = e.touch.entries[k, side, :3], e.touch.entries[k, side, 3:]
        push(e, e.touch.bodies[k, side], scale(-load, pick(along)), scale(-load, pick(about)))


@kernel
def press(e: Evaluation, k: int, law: Any) -> None:
    """W = k C + c C', C the overlap; a contact that is not bonded never pulls."""
    overlap = e.touch.value[k]
    load = law.stiffness * overlap + law.damping * close(e, k)
    if law.bonded == 0.0 and (overlap <= 0.0 or load < 0.0):
        load = 0.0
    push_apart(e, k, load)


class Film(NamedTuple):
    """State of a contact, as its law reads it."""

    film_thickness: float


class Surfaces(NamedTuple):
    """Inputs of a contact, as its law reads them."""

    approach: float
    approach_rate: float
    retreat: float
    retreat_rate: float
    entraining_velocity: float
    sliding_velocity: float
    radius_of_curvature: float
    applied_load: float


@kernel
def find_drift(e: Evaluation, row: Any) -> float:
    """Velocity of the cam's axis along the face, against the motion of its surface.

    Kushwaha et al. 2000, section 5, call the speed that it adds fictitious.
    """
    n, axis = carry(e, row.j, row.b), cross(carry(e, row.i, row.a).value, carry(e, row.i, row.a2).value)
    arm_i, arm_j = carry(e, row.i, row.p_i), carry(e, row.j, row.p_j)
    apart = differ(point_at(e, row.i, arm_i), point_at(e, row.j, arm_j))
    return dot(cross(n.value, axis), apart.rate)


@kernel
def meet(e: Evaluation, k: int, row: Any, curve: Curve, turning: float) -> Surfaces:
    """The surfaces of the contact k, whose row of `touch` is filled.

    R = R0 + s + s''; u = psi' (R0 + s + 2 s'')/2 + w/2, sliding psi' (R0 + s) - w, w the axis's drift.
    """
    base_radius, profile, drift = curve.base_radius, curve.lift, find_drift(e, row)
    return Surfaces(
        e.touch.value[k],
        close(e, k),
        0.0,
        0.0,
        0.5 * (turning * (base_radius + profile.s + 2.0 * profile.dds) + drift),
        turning * (base_radius + profile.s) - drift,
        base_radius + profile.s + profile.dds,
        0.0,
    )


@kernel
def lubricate(e: Evaluation, k: int, row: Any, curve: Curve, turning: float, film: float, oil: Any) -> None:
    """Load and film rate of the contact k, and its forces f = -J^T W."""
    # The law reads its records by name.
    state: Any = Film(film)
    surfaces: Any = meet(e, k, row, curve, turning)
    found = contact(state, surfaces, oil)
    e.film_rate[k] = found.film_rate
    push_apart(e, k, found.load)


@kernel
def multiply_field(matrix: Any, shift: Arrow, turn: Arrow, first: int) -> Arrow:
    """Three rows of a 6 x 6 matrix times (shift, turn)."""
    a, b, c = matrix[first], matrix[first + 1], matrix[first + 2]
    return Arrow(
        dot(pick(a), shift) + a[3] * turn.x + a[4] * turn.y + a[5] * turn.z,
        dot(pick(b), shift) + b[3] * turn.x + b[4] * turn.y + b[5] * turn.z,
        dot(pick(c), shift) + c[3] * turn.x + c[4] * turn.y + c[5] * turn.z,
    )


@kernel
def frame_to_ground(e: Evaluation, body: int, frame: Any, a: Arrow) -> Arrow:
    return to_ground(e.rotation[body], to_ground(frame, a))


@kernel
def ground_to_frame(e: Evaluation, body: int, frame: Any, a: Arrow) -> Arrow:
    return to_body(frame, to_body(e.rotation[body], a))


class Bent(NamedTuple):
    """Deformation of an elastic field, with its rate, in the axes of i's frame; A = R_i^T R_j by columns."""

    shift: Arrow
    shift_rate: Arrow
    turn: Arrow
    turn_rate: Arrow
    first: Arrow
    second: Arrow
    third: Arrow


@kernel
def turn_with(bent: Bent, torque: Arrow) -> Arrow:
    """G^T T: the moment on j of generalised forces T on the turn, whose rate is G w."""
    a, b, c = bent.first, bent.second, bent.third
    half = 0.5 * torque.x
    return Arrow(
        half * (b.y + c.z) - torque.y * a.y - torque.z * a.z,
        torque.y * a.x - half * b.x,
        torque.z * a.x - half * c.x,
    )


@kernel
def bend_field(e: Evaluation, s: Any) -> Bent:
    """The displacement d - rest and the turn theta = ((A32 - A23)/2, -A31, A21) of A = R_i^T R_j.

    A twist, and the slopes of j's first axis: turning j about that axis bends nothing. The turn's rate is
    G w at the relative angular velocity w.
    """
    arm_i, arm_j = carry(e, s.i, s.at_i), carry(e, s.j, s.at_j)
    d = differ(point_at(e, s.j, arm_j), point_at(e, s.i, arm_i))
    omega = pick(e.omega[s.i])
    shift = subtract(ground_to_frame(e, s.i, s.axes_i, d.value), pick(s.rest))
    shift_rate = ground_to_frame(e, s.i, s.axes_i, subtract(d.rate, cross(omega, d.value)))
    a = ground_to_frame(e, s.i, s.axes_i, frame_to_ground(e, s.j, s.axes_j, Arrow(1.0, 0.0, 0.0)))
    b = ground_to_frame(e, s.i, s.axes_i, frame_to_ground(e, s.j, s.axes_j, Arrow(0.0, 1.0, 0.0)))
    c = ground_to_frame(e, s.i, s.axes_i, frame_to_ground(e, s.j, s.axes_j, Arrow(0.0, 0.0, 1.0)))
    w = ground_to_frame(e, s.i, s.axes_i, subtract(pick(e.omega[s.j]), omega))
    twisting = 0.5 * ((b.y + c.z) * w.x - b.x * w.y - c.x * w.z)
    turn = Arrow(0.5 * (b.z - c.y), -a.z, a.y)
    turn_rate = Arrow(twisting, a.x * w.y - a.y * w.x, a.x * w.z - a.z * w.x)
    return Bent(shift, shift_rate, turn, turn_rate, a, b, c)


@kernel
def load_field(e: Evaluation, s: Any) -> None:
    """(F, T) = -K delta - C delta' on j, in the axes of i's frame (K (33) with its lost sign, Q (2)).

    The moment on j is G^T T, so that power is conserved at large turns too.
    """
    bent = bend_field(e, s)
    shift, shift_rate, turn, turn_rate = bent.shift, bent.shift_rate, bent.turn, bent.turn_rate
    force = scale(
        -1.0,
        add(multiply_field(s.stiffness, shift, turn, 0), multiply_field(s.damping, shift_rate, turn_rate, 0)),
    )
    torque = scale(
        -1.0,
        add(multiply_field(s.stiffness, shift, turn, 3), multiply_field(s.damping, shift_rate, turn_rate, 3)),
    )
    moment = frame_to_ground(e, s.i, s.axes_i, turn_with(bent, torque))
    force = frame_to_ground(e, s.i, s.axes_i, force)
    arm_j = carry(e, s.j, s.at_j).value
    reach = subtract(add(pick(e.position[s.j]), arm_j), pick(e.position[s.i]))
    push(e, s.j, force, add(moment, cross(arm_j, force)))
    push(e, s.i, scale(-1.0, force), scale(-1.0, add(moment, cross(reach, force))))
