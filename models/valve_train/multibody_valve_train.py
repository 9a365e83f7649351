"""The direct train of Kushwaha et al. 2000 (K) as rigid bodies with joints, in one component.

Shaft, cam, follower and spring masses have six coordinates each; Lagrange multipliers hold them in their
joints (K (34), (35)), and are the torque of the drive and the moment on the guide. Film thickness in, contact
load out: the component and a film formula are K's own coupling. Its equations are those of `multibody`, not
those of `camshaft` and `valve_spring`.
"""

from dataclasses import dataclass, make_dataclass
from typing import Any, NamedTuple

import numpy as np

from ..compile.kernel import kernel
from ..contact.ehl_contact import ContactParameters
from ..core import roles
from ..core.bonds import counts_energies
from ..core.component import NO_EVENT, Component, PowerBond
from ..core.quantities import Layout, Quantity, Vector, pick_fields
from ..core.requirements import Requirement
from ..multibody.coils import COIL_INERTIA, SPRING_LENGTH
from ..multibody.fill import fill_tables
from ..multibody.forces import ALONG_SHAFT
from ..multibody.train_energy import fill_energy, lengthen
from ..multibody.train_kernels import (
    CAM,
    DRIVE_ROW,
    FOLLOWER,
    GUIDE_ROW,
    SHAFT,
    Fixed,
    change_train,
    count_room,
    find_fastest,
    find_worst,
    list_rows,
    make_spring,
    make_train,
)
from ..multibody.train_parts import FOLLOWER_INERTIA, SHAFT_INERTIA, SHAFT_MASS, list_parts
from ..multibody.vectors import Arrow
from .cams.law import LAW
from .cams.profile import CamProfile, require_convexity, time_to_break
from .cams.table import TABLE, check_table
from .camshaft import CamshaftInputs, CamshaftOutputs, CamshaftParameters, TableCamshaftParameters
from .valve_spring import ValveSpringOutputs, ValveSpringParameters, lumping

# Its equations take a time that grows with the cube of the number of constraints, five for each mass.
MOST_COIL_MASSES = 10
# Violation of a constraint (m, rad), and of its rate (m/s, rad/s), with which a start still meets it: at
# 1e-9 m the terms that restore it make 1e-5 of the load.
MET, RATE_MET = 1e-9, 1e-6

# Fastest decay (1/s) that its explicit steps follow: a valve of 0.2 kg has 3e3, and at 1e7 a step of 5 us
# needs some twenty micro-steps.
FASTEST_DECAY = 1e7

FIXED = Fixed(
    SHAFT_MASS, Arrow(*SHAFT_INERTIA), Arrow(*FOLLOWER_INERTIA), Arrow(*COIL_INERTIA), SPRING_LENGTH
)


def _extend_parameters(camshaft: type) -> type:
    """The parameters of a camshaft, a valve on its spring, and two bodies in contact."""
    added = pick_fields(
        ValveSpringParameters, "valve_mass", "spring_rate", "surge_frequency", "damping_ratio", "preload"
    ) + pick_fields(
        ContactParameters, "length", "youngs_modulus_1", "poissons_ratio_1", "youngs_modulus_2",
        "poissons_ratio_2", "contact_damping", "damping_reference_load",
    )  # fmt: skip
    return make_dataclass("MultibodyParameters", added, bases=(camshaft,))


@dataclass
class MultibodyState:
    """Three of each body: shaft, cam, follower, spring masses. Of shaft and cam the turn about z counts from
    the drive, all else from the place at zero lift."""

    position: Vector = Quantity(
        "m", "displacement of a body: x, y, z of the first ...", nominal=1e-3, display_unit="mm", size="axes"
    ).per_element()
    angle: Vector = Quantity(
        "rad", "Cardan angles of a body", nominal=1e-3, display_unit="deg", size="axes"
    ).per_element()
    velocity: Vector = Quantity("m/s", "velocity of a body", size="axes").per_element()
    angular_velocity: Vector = Quantity("rad/s", "angular velocity of a body", size="axes").per_element()


MultibodyInputs = make_dataclass(
    "MultibodyInputs",
    [
        *pick_fields(CamshaftInputs, "drive_angle", "drive_speed", "drive_acceleration"),
        (
            "film_thickness",
            float,
            Quantity("m", "film between cam and follower", nominal=1e-6, display_unit="um").default(1e-6),
        ),
        ("film_rate", float, Quantity("m/s", "its rate, which the contact damps", nominal=1e-3).default()),
    ],
)


@dataclass
class _OwnOutputs:
    load: float = Quantity("N", "contact load W", nominal=500.0).default()
    elastic_load: float = Quantity("N", "contact load without its damping", nominal=500.0).default()
    deflection: float = Quantity(
        "m", "elastic approach of the bodies", nominal=1e-6, display_unit="um"
    ).default()
    guide_moment: float = Quantity("N.m", "moment of the follower on its guide", nominal=10.0).default()
    twist: float = Quantity("rad", "cam angle less driven angle", nominal=1e-4).default()
    axis_x: float = Quantity(
        "m", "displacement of the cam across the valve", nominal=1e-5, display_unit="um"
    ).default()
    axis_y: float = Quantity(
        "m", "displacement of the cam towards the valve", nominal=1e-5, display_unit="um"
    ).default()
    constraint_violation: float = Quantity(
        "1", "largest violation of a constraint (m or rad)", nominal=1e-9
    ).default()


MultibodyOutputs = make_dataclass(
    "MultibodyOutputs",
    [
        *pick_fields(ValveSpringOutputs, "position", "velocity", "acceleration", "spring_force"),
        *pick_fields(
            CamshaftOutputs, "entraining_velocity", "sliding_velocity", "radius_of_curvature",
            "drive_torque", "cam_angle", "cam_speed", "cam_lift", "contact_offset", "next_event",
        ),
    ],
    bases=(_OwnOutputs,),
)  # fmt: skip


@kernel
def is_heavy_enough(p: Any, numbers: Vector) -> bool:
    """Contact damping over mass, under the preload."""
    damping = p.contact_damping * p.preload / p.damping_reference_load
    numbers[0], numbers[1], numbers[2] = p.valve_mass, damping, damping / FASTEST_DECAY
    return damping <= FASTEST_DECAY * p.valve_mass


HEAVY_ENOUGH = Requirement(
    is_heavy_enough,
    "valve_mass = {0:g} kg: the contact's damping, {1:.3g} N.s/m under the preload, stops it faster than "
    "steps of time can follow: must be >= {2:.3g} kg; or reduce contact_damping",
)


class Drawn(NamedTuple):
    """Rows of K's constraints with their names, and that of the contact, of a train with a unit shaft."""

    rows: Vector
    names: tuple[str, ...]
    touch: Vector


def draw_train(parameters: Layout, coil_masses: int, profile: CamProfile) -> Drawn:
    """The train as numbers for kernels."""
    p = parameters.defaults()
    p.shaft_length, p.phase, p.flexible = 1.0, 0.0, 0.0
    parts = list_parts(p, p, 0.0, coil_masses=coil_masses, lubricant=p)
    names = ["ground", *(body.name for body in parts.bodies)]
    tables = fill_tables(parts.bodies, parts.joints, parts.forces, (0.0, 0.0, 0.0), profile, names.index)
    held = tuple(
        f"{joint.name}: {constraint.name}" for joint in parts.joints for constraint in joint.constraints
    )
    return Drawn(list_rows(tables.rows), held, list_rows(tables.touches))


def _require_start(one: str, other: str, met: Any, limit: float, names: tuple[str, ...]) -> Requirement:
    return Requirement(
        met,
        f"{one}: with {other} the start violates {{word}} by {{1:.3g}}: must be <= {limit:g} in SI units; "
        "leave it at 0, where the parts fit together, or take it from a run",
        words=names,
    )


@counts_energies
def multibody_valve_train(coil_masses: int = 2, table_points: int = 0) -> Component:
    """A direct train of 3 + `coil_masses` bodies; its cam by a law, or through `table_points` points."""
    check_table(table_points)
    if not 1 <= coil_masses <= MOST_COIL_MASSES:
        raise ValueError(
            f"coil_masses = {coil_masses}: must be from 1 to {MOST_COIL_MASSES} in a train of bodies"
        )
    profile, camshaft = (TABLE, TableCamshaftParameters) if table_points else (LAW, CamshaftParameters)
    sizes = {"coil_masses": coil_masses, "table_points": table_points}
    parameters = Layout(_extend_parameters(camshaft), sizes)
    bodies, shares = FOLLOWER + coil_masses, lumping(coil_masses)
    rows, held_names, touch = draw_train(parameters, coil_masses, profile)
    solve_train = make_train(rows, touch, ALONG_SHAFT, FIXED, shares, profile.lift)
    size = count_room(bodies, len(rows))
    find_breaks = profile.find_breaks
    cam, shaft, follower = CAM - 1, SHAFT - 1, FOLLOWER - 1

    # The train lies in `room`, which the caller keeps.
    @kernel
    def change(x: Any, u: Any, p: Any, dx: Any, room: Vector) -> None:
        change_train(solve_train(x, u, p, room), x, dx)

    @kernel
    def derivative(t: float, x: Any, u: Any, p: Any, dx: Any) -> None:
        change(x, u, p, dx, np.zeros(size))

    @kernel
    def show(t: float, x: Any, u: Any, p: Any, y: Any, room: Vector) -> None:
        train = solve_train(x, u, p, room)
        surfaces, held = train.surfaces, train.e.held
        y.load, y.elastic_load, y.deflection = train.load, train.elastic_load, train.deflection
        y.entraining_velocity, y.sliding_velocity = surfaces.entraining_velocity, surfaces.sliding_velocity
        y.radius_of_curvature = surfaces.radius_of_curvature
        y.drive_torque = p.drive_ratio * train.multipliers[DRIVE_ROW]
        y.guide_moment = 0.0
        for k in range(GUIDE_ROW, GUIDE_ROW + 5):
            y.guide_moment += train.multipliers[k] * held.entries[k, 1, 5]
        y.position, y.velocity = x.position[3 * follower + 1], x.velocity[3 * follower + 1]
        y.acceleration = train.acceleration[6 * follower + 1]
        s = make_spring(0, coil_masses, shares, FIXED, p)
        length, rate = lengthen(train.e, s)
        y.spring_force = -s.stiffness * (length - s.length) - s.damping * rate
        y.twist = x.angle[3 * cam + 2] - x.angle[3 * shaft + 2]
        y.cam_angle, y.cam_speed = train.drive.angle + x.angle[3 * cam + 2], train.cam_speed
        y.cam_lift = train.cam.s
        y.contact_offset = train.cam.ds + x.position[3 * cam] - x.position[3 * follower]
        y.axis_x, y.axis_y = x.position[3 * cam], x.position[3 * cam + 1]
        y.constraint_violation = find_worst(train.e).violation
        breaks = find_breaks(train.cam_angle, p)
        acceleration = train.acceleration[6 * cam + 5]
        y.next_event = min(t + time_to_break(breaks, train.cam_speed, acceleration), NO_EVENT)

    @kernel
    def output(t: float, x: Any, u: Any, p: Any, y: Any) -> None:
        show(t, x, u, p, y, np.zeros(size))

    @kernel
    def count(x: Any, u: Any, p: Any, e: Vector, room: Vector) -> None:
        fill_energy(solve_train(x, u, p, room), coil_masses, shares, FIXED, u, p, e)

    @kernel
    def energy(t: float, x: Any, u: Any, p: Any, e: Vector) -> None:
        count(x, u, p, e, np.zeros(size))

    @kernel
    def is_together(x: Any, u: Any, p: Any, numbers: Vector) -> bool:
        worst = find_worst(solve_train(x, u, p, np.zeros(size)).e)
        numbers[0], numbers[1] = worst.row, worst.violation
        return worst.violation <= MET

    @kernel
    def moves_together(x: Any, u: Any, p: Any, numbers: Vector) -> bool:
        fastest = find_fastest(solve_train(x, u, p, np.zeros(size)))
        numbers[0], numbers[1] = fastest.row, fastest.violation
        return fastest.violation <= RATE_MET

    inputs = Layout(MultibodyInputs)
    angle, speed = ("drive_angle",), ("drive_angle", "drive_speed")
    axes = {"axes": 3 * bodies}
    # The shaft slides in its bearing (K: a cylindrical joint): along z nothing holds shaft and cam.
    sliding = {f"{name}[{3 * body + 3}]" for name in ("position", "velocity") for body in (shaft, cam)}
    state = Layout(MultibodyState, axes)
    return Component(
        name="multibody_valve_train",
        description="Direct-acting valve train as rigid bodies with joints, without its film",
        roles=(roles.Cam("cam_angle", "radius_of_curvature", "drive_torque"),),
        parameters=parameters,
        state=state,
        inputs=inputs,
        outputs=Layout(MultibodyOutputs),
        derivative=derivative,
        output=output,
        energy=energy,
        feedthrough={
            "load": inputs.names,
            "elastic_load": ("drive_angle", "film_thickness"),
            "deflection": ("drive_angle", "film_thickness"),
            "acceleration": inputs.names,
            "drive_torque": inputs.names,
            "guide_moment": inputs.names,
            "next_event": inputs.names,
            "entraining_velocity": speed,
            "sliding_velocity": speed,
            "radius_of_curvature": angle,
            "cam_angle": angle,
            "cam_speed": speed,
            "cam_lift": angle,
            "contact_offset": angle,
            "constraint_violation": angle,
        },
        bonds=(PowerBond("drive_torque", "drive_speed", +1),),
        requirements=(*profile.requirements, require_convexity(profile), HEAVY_ENOUGH),
        start_requirements=(
            _require_start("position", "angle", is_together, MET, held_names),
            _require_start("velocity", "angular_velocity", moves_together, RATE_MET, held_names),
        ),
        structure=sizes,
        resting=tuple(name for name in state.names if name not in sliding),
        event_indicators=("deflection", "entraining_velocity"),
        next_event="next_event",
    )
