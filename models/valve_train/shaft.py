"""Shaft with any number of cams: torsion, and bending in two planes, by modes.

The modes are parameters: `beam` finds them for a round shaft, and those of any other program will do. The
shaft turns about z, anticlockwise. Damping of bending turns with the shaft, as that of its material does.
"""

import math
from dataclasses import dataclass
from typing import NamedTuple

from .. import kinds
from ..compile.kernel import kernel
from ..core import roles
from ..core.component import Component, PowerBond, check_sizes
from ..core.integrator import FINE_TOLERANCE
from ..core.quantities import Quantity, Vector, layouts
from .shared import DriveInputs


@dataclass
class Parameters:
    """Defaults: one mode of torsion and one of bending, of the size of those of the set `kushwaha2000`."""

    drive_ratio: float = kinds.NUMBER(
        "shaft angle over drive angle (0.5 behind a four-stroke crankshaft)", 1.0
    )
    inertia: float = kinds.INERTIA("moment of inertia of the whole shaft", 3e-4)
    torsion_frequency: Vector = Quantity(
        "Hz", "frequency of a mode of torsion", nominal=1e3, positive=True, size="torsion_modes"
    ).per_element(1000.0)
    torsion_damping: Vector = kinds.DAMPING_RATIO.each(
        "damping ratio of a mode of torsion", "torsion_modes", 0.02
    )
    torsion_inertia: Vector = kinds.INERTIA.each("modal inertia of a mode of torsion", "torsion_modes", 3e-4)
    torsion_share: Vector = Quantity(
        "kg.m2", "part of a mode of torsion in turning the whole shaft, phi^T M 1",
        nominal=1e-4, size="torsion_modes",
    ).per_element(3e-4)  # fmt: skip
    torsion_shape: Vector = kinds.NUMBER.each(
        "twist at the cams in a mode of torsion: all cams in the first mode, then in the second ...",
        "torsion_shapes",
        1.0,
    )
    bending_frequency: Vector = Quantity(
        "Hz", "frequency of a mode of bending; 0: rigid motion",
        nominal=1e3, minimum=0.0, size="bending_modes",
    ).per_element(540.0)  # fmt: skip
    bending_damping: Vector = kinds.DAMPING_RATIO.each(
        "damping ratio of a mode of bending", "bending_modes", 0.02
    )
    bending_mass: Vector = kinds.MASS.each(
        "modal mass of a mode of bending", "bending_modes", 0.425, nominal=0.1, positive=True
    )
    bending_shape: Vector = kinds.NUMBER.each(
        "displacement of the cams in a mode of bending: all cams in the first, then in the second ...",
        "bending_shapes",
        1.0,
    )
    gyroscopic: Vector = kinds.MASS.each(
        "gyroscopic coupling of two modes of bending, row by row", "bending_pairs"
    )
    direction: Vector = kinds.PHASE.each("direction of a cam's follower, anticlockwise from y", "cams")


@dataclass
class State:
    """Coordinates of the modes."""

    torsion: Vector = kinds.TILT.each("coordinate of a mode of torsion", "torsion_modes", nominal=1e-4)
    torsion_rate: Vector = kinds.ROTATION_RATE.each("its rate", "torsion_modes", nominal=1.0)
    bending_x: Vector = kinds.PLACE.each(
        "coordinate of a mode of bending along x", "bending_modes", nominal=1e-5
    )
    bending_x_rate: Vector = kinds.VELOCITY.each("its rate", "bending_modes", nominal=1e-2)
    bending_y: Vector = kinds.PLACE.each(
        "coordinate of a mode of bending along y", "bending_modes", nominal=1e-5
    )
    bending_y_rate: Vector = kinds.VELOCITY.each("its rate", "bending_modes", nominal=1e-2)


@dataclass
class Inputs(DriveInputs):
    cam_torque: Vector = kinds.TORQUE.each("torque taken by a follower", "cams")
    cam_force_x: Vector = kinds.FORCE.each("force on a cam across its follower's path", "cams")
    cam_force_y: Vector = kinds.FORCE.each("force on a cam towards its follower", "cams")


@dataclass
class Outputs:
    cam_angle: Vector = kinds.ANGLE.each("angle of the shaft at a cam", "cams")
    cam_speed: Vector = kinds.SPEED.each("speed of the shaft at a cam", "cams")
    twist: Vector = kinds.ANGLE.each("twist of the shaft at a cam", "cams", nominal=1e-3)
    axis_x: Vector = kinds.DEFLECTION.each("displacement of a cam across its follower's path", "cams")
    axis_y: Vector = kinds.DEFLECTION.each("displacement of a cam towards its follower", "cams")
    axis_velocity_x: Vector = kinds.VELOCITY.each("rate of axis_x", "cams", nominal=0.1)
    axis_velocity_y: Vector = kinds.VELOCITY.each("rate of axis_y", "cams", nominal=0.1)
    drive_torque: float = kinds.TORQUE("torque taken from the drive")


class Plane(NamedTuple):
    """Along x and y."""

    x: float
    y: float


@kernel
def torsion_acceleration(j: int, x: State, u: Inputs, p: Parameters) -> float:
    w, cams = 2.0 * math.pi * p.torsion_frequency[j], p.direction.size
    torque = -p.torsion_share[j] * p.drive_ratio * u.drive_acceleration
    for i in range(cams):
        torque -= p.torsion_shape[j * cams + i] * u.cam_torque[i]
    own = 2.0 * p.torsion_damping[j] * w * x.torsion_rate[j] + w * w * x.torsion[j]
    return torque / p.torsion_inertia[j] - own


@kernel
def damp_bending(j: int, x: State, u: Inputs, p: Parameters) -> Plane:
    """2 zeta w m (q' - i Omega q)."""
    c = 4.0 * math.pi * p.bending_damping[j] * p.bending_frequency[j] * p.bending_mass[j]
    turning = p.drive_ratio * u.drive_speed
    return Plane(
        c * (x.bending_x_rate[j] + turning * x.bending_y[j]),
        c * (x.bending_y_rate[j] - turning * x.bending_x[j]),
    )


@kernel
def load_bending(j: int, u: Inputs, p: Parameters) -> Plane:
    """phi^T F: forces are given in the directions of the followers."""
    force_x, force_y, cams = 0.0, 0.0, p.direction.size
    for i in range(cams):
        shape, c, s = p.bending_shape[j * cams + i], math.cos(p.direction[i]), math.sin(p.direction[i])
        force_x += shape * (c * u.cam_force_x[i] - s * u.cam_force_y[i])
        force_y += shape * (s * u.cam_force_x[i] + c * u.cam_force_y[i])
    return Plane(force_x, force_y)


@kernel
def bending_acceleration(j: int, x: State, u: Inputs, p: Parameters) -> Plane:
    modes = p.bending_frequency.size
    stiffness = p.bending_mass[j] * (2.0 * math.pi * p.bending_frequency[j]) ** 2
    load, damped = load_bending(j, u, p), damp_bending(j, x, u, p)
    force_x = load.x - damped.x - stiffness * x.bending_x[j]
    force_y = load.y - damped.y - stiffness * x.bending_y[j]
    for k in range(modes):
        coupling = p.drive_ratio * u.drive_speed * p.gyroscopic[j * modes + k]
        force_x -= coupling * x.bending_y_rate[k]
        force_y += coupling * x.bending_x_rate[k]
    return Plane(force_x / p.bending_mass[j], force_y / p.bending_mass[j])


@kernel
def derivative(t: float, x: State, u: Inputs, p: Parameters, dx: State) -> None:
    for j in range(p.torsion_frequency.size):
        dx.torsion[j] = x.torsion_rate[j]
        dx.torsion_rate[j] = torsion_acceleration(j, x, u, p)
    for j in range(p.bending_frequency.size):
        bent = bending_acceleration(j, x, u, p)
        dx.bending_x[j], dx.bending_x_rate[j] = x.bending_x_rate[j], bent.x
        dx.bending_y[j], dx.bending_y_rate[j] = x.bending_y_rate[j], bent.y


@kernel
def show_twist(i: int, x: State, u: Inputs, p: Parameters, y: Outputs) -> None:
    twist, rate, cams = 0.0, 0.0, p.direction.size
    for j in range(p.torsion_frequency.size):
        twist += p.torsion_shape[j * cams + i] * x.torsion[j]
        rate += p.torsion_shape[j * cams + i] * x.torsion_rate[j]
    y.twist[i] = twist
    y.cam_angle[i] = p.drive_ratio * u.drive_angle + twist
    y.cam_speed[i] = p.drive_ratio * u.drive_speed + rate


@kernel
def show_axis(i: int, x: State, p: Parameters, y: Outputs) -> None:
    moved_x, moved_y, rate_x, rate_y, cams = 0.0, 0.0, 0.0, 0.0, p.direction.size
    for j in range(p.bending_frequency.size):
        shape = p.bending_shape[j * cams + i]
        moved_x += shape * x.bending_x[j]
        moved_y += shape * x.bending_y[j]
        rate_x += shape * x.bending_x_rate[j]
        rate_y += shape * x.bending_y_rate[j]
    c, s = math.cos(p.direction[i]), math.sin(p.direction[i])
    y.axis_x[i], y.axis_y[i] = c * moved_x + s * moved_y, c * moved_y - s * moved_x
    y.axis_velocity_x[i], y.axis_velocity_y[i] = c * rate_x + s * rate_y, c * rate_y - s * rate_x


@kernel
def drive_torque(x: State, u: Inputs, p: Parameters) -> float:
    """What the followers and the shaft's inertia take, and the damping that turns round the bent shaft."""
    torque = p.inertia * p.drive_ratio * u.drive_acceleration
    for i in range(p.direction.size):
        torque += u.cam_torque[i]
    for j in range(p.torsion_frequency.size):
        torque += p.torsion_share[j] * torsion_acceleration(j, x, u, p)
    for j in range(p.bending_frequency.size):
        damped = damp_bending(j, x, u, p)
        torque += damped.x * x.bending_y[j] - damped.y * x.bending_x[j]
    return p.drive_ratio * torque


@kernel
def output(t: float, x: State, u: Inputs, p: Parameters, y: Outputs) -> None:
    for i in range(p.direction.size):
        show_twist(i, x, u, p, y)
        show_axis(i, x, p, y)
    y.drive_torque = drive_torque(x, u, p)


@kernel
def energy(t: float, x: State, u: Inputs, p: Parameters, e: Vector) -> None:
    speed = p.drive_ratio * u.drive_speed
    stored, lost = 0.5 * p.inertia * speed * speed, 0.0
    for j in range(p.torsion_frequency.size):
        w, inertia, rate = 2.0 * math.pi * p.torsion_frequency[j], p.torsion_inertia[j], x.torsion_rate[j]
        stored += p.torsion_share[j] * speed * rate + 0.5 * inertia * rate * rate
        stored += 0.5 * inertia * (w * x.torsion[j]) ** 2
        lost += 2.0 * inertia * p.torsion_damping[j] * w * rate * rate
    for j in range(p.bending_frequency.size):
        w, damped = 2.0 * math.pi * p.bending_frequency[j], damp_bending(j, x, u, p)
        moving = x.bending_x_rate[j] ** 2 + x.bending_y_rate[j] ** 2
        stored += 0.5 * p.bending_mass[j] * (moving + w * w * (x.bending_x[j] ** 2 + x.bending_y[j] ** 2))
        lost += damped.x * (x.bending_x_rate[j] + speed * x.bending_y[j])
        lost += damped.y * (x.bending_y_rate[j] - speed * x.bending_x[j])
    e[0], e[1], e[2] = stored, lost, 0.0


def shaft(cams: int = 1, torsion_modes: int = 1, bending_modes: int = 1) -> Component:
    """Torsion: I (t'' + 2 zeta w t' + w^2 t) = -phi^T T - (phi^T M 1) psi''. Bending, with q = x + i y:
    m (q'' + 2 zeta w (q' - i Omega q) + w^2 q) = phi^T F + i Omega Gamma q'."""
    check_sizes(cams=cams, torsion_modes=torsion_modes, bending_modes=bending_modes)
    structure = {"cams": cams, "torsion_modes": torsion_modes, "bending_modes": bending_modes}
    sizes = {
        **structure,
        "torsion_shapes": cams * torsion_modes,
        "bending_shapes": cams * bending_modes,
        "bending_pairs": bending_modes * bending_modes,
    }

    def each(name: str) -> list[str]:
        return [f"{name}[{i + 1}]" for i in range(cams)]

    return Component(
        tolerance=FINE_TOLERANCE,
        name="shaft",
        description="Shaft with cams: torsion and bending by modes",
        roles=(roles.DrawnShaft(),),
        **layouts(Parameters, State, Inputs, Outputs, sizes),
        derivative=derivative,
        output=output,
        energy=energy,
        feedthrough={
            **dict.fromkeys(each("cam_angle"), ("drive_angle",)),
            **dict.fromkeys(each("cam_speed"), ("drive_speed",)),
            "drive_torque": ("drive_speed", "drive_acceleration", *each("cam_torque")),
        },
        bonds=(
            PowerBond("drive_torque", "drive_speed", +1),
            *(PowerBond(t, w, -1) for t, w in zip(each("cam_torque"), each("cam_speed"), strict=True)),
            *(PowerBond(f, v, +1) for f, v in zip(each("cam_force_x"), each("axis_velocity_x"), strict=True)),
            *(PowerBond(f, v, +1) for f, v in zip(each("cam_force_y"), each("axis_velocity_y"), strict=True)),
        ),
        structure=structure,
    )
