"""The direct train in kernels: its parameters, drive and film may change, its parts and joints do not.

`direct_train` draws the mechanism, once, with a shaft of unit length; all places of its joints are shares of
that length. Coordinates count from where the parts stand before the cam lifts, and turn with the drive.
"""

from typing import Any, NamedTuple

import numpy as np

from ..compile.kernel import kernel, shaped
from ..contact.ehl_contact import damping_margin
from ..contact.hertz import find_load, pair_compliance
from ..core.quantities import Vector
from ..valve_train.cams.lift import Lift
from ..valve_train.valve_spring import Lumping
from .beams import fill_beam_stiffness, fill_modal_damping
from .coils import find_coil_mass, make_segment
from .constraints import Curve, constrain, find_cam_angle, follow_cam
from .loads import load_field, load_spring, push_apart
from .lubrication import Surfaces, meet
from .multipliers import Inertia, multiply_row, solve_motion
from .rigid import load_inertia, place_bodies
from .tables import Evaluation, Rows
from .vectors import Arrow, turn_angles

# Bodies, and where the ground stands in their place; coils follow.
GROUND, SHAFT, CAM, FOLLOWER, FIRST_COIL = range(5)
# Rows of the constraints: the bearing has 4, the drive 1, the guide 5. The last 6 make a shaft rigid.
DRIVE_ROW, GUIDE_ROW, FIRST_COIL_ROW, RIGID_ROWS = 4, 5, 10, 6
# Rate (1/s) at which a violated constraint is restored (Baumgarte 1972): slower than the contact's vibration,
# faster than that of the shaft. A motion without violation does not see it.
RESTORING = 5e3


class Row(NamedTuple):
    """A scalar constraint, as the kernels of constraints read it."""

    kind: int
    i: int
    j: int
    a: Arrow
    a2: Arrow
    b: Arrow
    p_i: Arrow
    p_j: Arrow
    offset: float
    angle: float
    speed: float
    acceleration: float


class Spring(NamedTuple):
    """A spring, as `load_spring` reads it."""

    i: int
    j: int
    p_i: Arrow
    p_j: Arrow
    length: float
    stiffness: float
    damping: float


class Field(NamedTuple):
    """An elastic field, as `load_field` reads it."""

    i: int
    j: int
    p_i: Arrow
    p_j: Arrow
    e_i: Any
    e_j: Any
    rest: Arrow
    stiffness: Any
    damping: Any


class Drive(NamedTuple):
    """The driven end: angle (rad), speed (rad/s), acceleration (rad/s^2)."""

    angle: float
    speed: float
    acceleration: float


class Train(NamedTuple):
    """The train at an instant, with its accelerations (6 n,) and multipliers."""

    e: Evaluation
    inertia: Inertia
    field: Field
    drive: Drive
    q: Vector
    v: Vector
    cam: Lift
    cam_angle: float
    cam_speed: float
    surfaces: Surfaces
    deflection: float
    deflection_rate: float
    elastic_load: float
    load: float
    acceleration: Vector
    multipliers: Vector


def list_rows(rows: Any) -> Vector:
    """The rows of a mechanism as numbers, for `read_row`."""
    vectors = ("a", "a2", "b", "p_i", "p_j")
    listed = [
        [r["kind"], r["i"], r["j"], *np.concatenate([r[name] for name in vectors]), r["offset"]] for r in rows
    ]
    return np.array(listed, float)


@kernel
def read_arrow(numbers: Any, first: int, size: float) -> Arrow:
    return Arrow(size * numbers[first], size * numbers[first + 1], size * numbers[first + 2])


@kernel
def read_row(numbers: Any, length: float, drive: Drive) -> Row:
    """The constraint, with points of a train whose shaft has that length."""
    return Row(
        int(numbers[0]), int(numbers[1]), int(numbers[2]),
        read_arrow(numbers, 3, 1.0), read_arrow(numbers, 6, 1.0), read_arrow(numbers, 9, 1.0),
        read_arrow(numbers, 12, length), read_arrow(numbers, 15, length), length * numbers[18],
        drive.angle, drive.speed, drive.acceleration,
    )  # fmt: skip


@kernel
def count_room(bodies: int, held: int) -> int:
    """Numbers that an evaluation with one contact needs, and coordinates, velocities and gamma besides."""
    return 18 * (bodies + 1) + 42 * bodies + 15 * (held + 1) + bodies + 2 + 12 * bodies + held


@kernel
def carve_rows(room: Vector, at: int, ends: Any, moving: Vector) -> Rows:
    """Rows between the bodies `ends` in the vector `room`, from the place `at` on."""
    count = ends.shape[0]
    free = at + 12 * count
    return Rows(
        shaped(room[free : free + count], (count,)),
        shaped(room[at:free], (count, 2, 6)),
        shaped(room[free + count : free + 2 * count], (count,)),
        shaped(room[free + 2 * count : free + 3 * count], (count,)),
        ends,
        moving,
    )


@kernel
def carve_evaluation(room: Vector, bodies: int, held: int) -> Evaluation:
    """An evaluation in the vector `room` of zeros, without references that would be counted."""
    count, size = bodies + 1, 6 * bodies
    blocks = 18 * count
    force = blocks + 36 * bodies
    rows = force + size
    touch = rows + 15 * held
    rest = touch + 15
    rotation = shaped(room[9 * count : 18 * count], (count, 3, 3))
    for i in range(3):
        rotation[0, i, i] = 1.0
    moving = shaped(room[rest : rest + bodies], (bodies,))
    return Evaluation(
        shaped(room[: 3 * count], (count, 3)),
        rotation,
        shaped(room[3 * count : 6 * count], (count, 3)),
        shaped(room[6 * count : 9 * count], (count, 3)),
        shaped(room[blocks:force], (bodies, 6, 6)),
        shaped(room[force:rows], (size,)),
        carve_rows(room, rows, np.zeros((held, 2), np.int64), moving),
        carve_rows(room, touch, np.zeros((1, 2), np.int64), moving),
        shaped(room[rest + bodies : rest + bodies + 1], (1,)),
        shaped(room[rest + bodies + 1 : rest + bodies + 2], (1,)),
    )


@kernel
def hold(e: Evaluation, k: int, row: Row) -> None:
    """Fill the constraint k."""
    e.held.bodies[k, 0], e.held.bodies[k, 1] = row.i, row.j
    constrain(0.0, e, e.held, k, row)


@kernel
def find_drive(u: Any, p: Any) -> Drive:
    ratio = p.drive_ratio
    return Drive(ratio * u.drive_angle + p.phase, ratio * u.drive_speed, ratio * u.drive_acceleration)


@kernel
def make_field(p: Any, axes: Any) -> Field:
    """K (33) between the driven end and the cam, every mode damped alike."""
    stiffness, damping, masses = np.empty((6, 6)), np.empty((6, 6)), np.empty(6)
    fill_beam_stiffness(p.shaft_length, p.shaft_diameter, p.youngs_modulus, p.poissons_ratio, 0.0, stiffness)
    masses[:3], masses[3], masses[4:] = p.mass, p.polar_inertia, p.transverse_inertia
    fill_modal_damping(stiffness, masses, p.shaft_damping_ratio, damping)
    centre, rest = Arrow(0.0, 0.0, 0.0), Arrow(p.shaft_length, 0.0, 0.0)
    return Field(SHAFT, CAM, centre, centre, axes, axes, rest, stiffness, damping)


@kernel
def turns_with_drive(body: int) -> bool:
    return body in (SHAFT, CAM)


class Fixed(NamedTuple):
    """What no parameter changes: masses and inertias of parts that no load moves, and the spring's length."""

    shaft_mass: float
    shaft_inertia: Arrow
    follower_inertia: Arrow
    coil_inertia: Arrow
    spring_length: float


@kernel
def fill_inertia(inertia: Inertia, lumping: Lumping, fixed: Fixed, p: Any) -> None:
    inertia.mass[SHAFT - 1], inertia.mass[CAM - 1] = fixed.shaft_mass, p.mass
    inertia.mass[FOLLOWER - 1] = p.valve_mass
    inertia.mass[FIRST_COIL - 1 :] = find_coil_mass(lumping.mass, p)
    for i in range(3):
        inertia.inertia[SHAFT - 1, i] = fixed.shaft_inertia[i]
        inertia.inertia[CAM - 1, i] = p.transverse_inertia if i < 2 else p.polar_inertia
        inertia.inertia[FOLLOWER - 1, i] = fixed.follower_inertia[i]
        inertia.inertia[FIRST_COIL - 1 :, i] = fixed.coil_inertia[i]


@kernel
def place_train(x: Any, drive: Drive, fixed: Fixed, p: Any, q: Vector, v: Vector) -> None:
    """Coordinates and velocities of the bodies, whose states count from their places at zero lift."""
    bodies = q.shape[0] // 6
    installed = fixed.spring_length / (bodies - 2)
    for b in range(bodies):
        for i in range(3):
            q[6 * b + i], q[6 * b + 3 + i] = x.position[3 * b + i], x.angle[3 * b + i]
            v[6 * b + i], v[6 * b + 3 + i] = x.velocity[3 * b + i], x.angular_velocity[3 * b + i]
        if turns_with_drive(b + 1):
            q[6 * b + 5] += drive.angle
            v[6 * b + 5] += drive.speed
        if b + 1 != SHAFT:
            q[6 * b + 2] += p.shaft_length
        if b + 1 >= FOLLOWER:
            q[6 * b + 1] += p.base_radius + (b + 1 - FOLLOWER) * installed


@kernel
def make_spring(k: int, coils: int, lumping: Lumping, fixed: Fixed, p: Any) -> Spring:
    """The segment above the mass k of the spring; the follower is number 0, the last one ends at the head."""
    centre = Arrow(0.0, 0.0, 0.0)
    share = lumping.end_rate if k == 0 or k == coils else lumping.inner_rate
    s = make_segment(share, fixed.spring_length / (coils + 1), p)
    if k < coils:
        return Spring(FOLLOWER + k, FOLLOWER + k + 1, centre, centre, s.length, s.stiffness, s.damping)
    head = Arrow(0.0, p.base_radius + fixed.spring_length, p.shaft_length)
    return Spring(FOLLOWER + k, GROUND, centre, head, s.length, s.stiffness, s.damping)


def make_train(
    rows: Vector, touch: Vector, axes: Vector, fixed: Fixed, lumping: Lumping, profile_lift: Any
) -> Any:
    """The kernel solve_train(x, u, p, room) -> Train; `rows` and `touch` as `list_rows` gives them.

    The train lies in `room`, `count_room` zeros, and is valid as long as that is.
    """
    coils = (rows.shape[0] - RIGID_ROWS - FIRST_COIL_ROW) // 5
    bodies = FIRST_COIL - 1 + coils

    @kernel
    def solve_train(x: Any, u: Any, p: Any, room: Vector) -> Train:
        held = rows.shape[0] - (RIGID_ROWS if p.flexible != 0.0 else 0)
        size = 6 * bodies
        e, drive, field = carve_evaluation(room, bodies, held), find_drive(u, p), make_field(p, axes)
        rest = room[count_room(bodies, held) - 2 * size - held :]
        q, v = shaped(rest[:size], (size,)), shaped(rest[size : 2 * size], (size,))
        gamma = shaped(rest[2 * size : 2 * size + held], (held,))
        inertia = Inertia(np.empty(bodies), np.empty((bodies, 3)), np.zeros((bodies, 3)), np.zeros(3))
        fill_inertia(inertia, lumping, fixed, p)
        place_train(x, drive, fixed, p, q, v)
        place_bodies(q, v, e)
        for b in range(bodies):
            load_inertia(b, inertia, e)
        for k in range(held):
            hold(e, k, read_row(rows[k], p.shaft_length, drive))
        for k in range(coils + 1):
            load_spring(e, make_spring(k, coils, lumping, fixed, p))
        if p.flexible != 0.0:
            load_field(e, field)
        row = read_row(touch[0], p.shaft_length, drive)
        cam_angle = find_cam_angle(e, row)
        curve = Curve(p.base_radius, profile_lift(cam_angle, p))
        e.touch.bodies[0, 0], e.touch.bodies[0, 1] = row.i, row.j
        turning = follow_cam(e, e.touch, 0, row, curve)
        surfaces = meet(e, 0, row, curve, turning)
        deflection = surfaces.approach + u.film_thickness
        deflection_rate = surfaces.approach_rate + u.film_rate
        elastic = find_load(deflection, surfaces.radius_of_curvature, p.length, pair_compliance(p))
        load = elastic * max(0.0, damping_margin(deflection_rate, p))
        push_apart(e, 0, load)
        for k in range(held):
            rate = e.held.rate[k] + multiply_row(e.held, k, v)
            gamma[k] = e.held.gamma[k] - 2.0 * RESTORING * rate - RESTORING**2 * e.held.value[k]
        motion = solve_motion(inertia, e, gamma)
        return Train(
            e, inertia, field, drive, q, v, curve.lift, cam_angle, turning, surfaces, deflection,
            deflection_rate, elastic, load, motion.acceleration, motion.multipliers,
        )  # fmt: skip

    return solve_train


@kernel
def change_train(train: Train, x: Any, dx: Any) -> None:
    """q' = T v and v' = a, relative to the drive."""
    for b in range(train.q.shape[0] // 6):
        omega = Arrow(train.e.omega[b + 1, 0], train.e.omega[b + 1, 1], train.e.omega[b + 1, 2])
        turned = turn_angles(train.q[6 * b + 3 : 6 * b + 6], omega)
        dx.angle[3 * b], dx.angle[3 * b + 1], dx.angle[3 * b + 2] = turned.x, turned.y, turned.z
        for i in range(3):
            dx.position[3 * b + i] = x.velocity[3 * b + i]
            dx.velocity[3 * b + i] = train.acceleration[6 * b + i]
            dx.angular_velocity[3 * b + i] = train.acceleration[6 * b + 3 + i]
        if turns_with_drive(b + 1):
            dx.angle[3 * b + 2] -= train.drive.speed
            dx.angular_velocity[3 * b + 2] -= train.drive.acceleration


class Violated(NamedTuple):
    """The constraint that is violated most, and by how much: m or rad, or their rates."""

    row: int
    violation: float


@kernel
def find_worst(e: Evaluation) -> Violated:
    """Largest |C|."""
    worst = Violated(0, 0.0)
    for k in range(e.held.value.shape[0]):
        if not abs(e.held.value[k]) <= worst.violation:
            worst = Violated(k, abs(e.held.value[k]))
    return worst


@kernel
def find_fastest(train: Train) -> Violated:
    """Largest |J v + C_t|."""
    worst, held = Violated(0, 0.0), train.e.held
    for k in range(held.value.shape[0]):
        rate = abs(held.rate[k] + multiply_row(held, k, train.v))
        if not rate <= worst.violation:
            worst = Violated(k, rate)
    return worst
