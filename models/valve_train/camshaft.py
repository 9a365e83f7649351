"""Camshaft: cam at the end of an elastic shaft element whose other end is driven.

Kushwaha et al. 2000 (K), section 4.2. Contact load bends the shaft by W and twists it by W s'; friction bends
it across. The turning of shaft and cam couples both planes of bending. Nothing moves the cam along the shaft.
"""

import math
from dataclasses import dataclass
from typing import Any

from .. import kinds
from ..compile.kernel import kernel
from ..core import roles
from ..core.component import NO_EVENT, Component, PowerBond
from ..core.integrator import FINE_TOLERANCE
from ..core.quantities import Vector, layouts
from .cams.choice import choose_profile
from .cams.lift import Lift
from .cams.profile import (
    CamProfile,
    entraining_velocity,
    radius_of_curvature,
    require_convexity,
    sliding_velocity,
    time_to_break,
)
from .shaft_element import (
    Load,
    Shaft,
    bend_shaft,
    bending_energy,
    damp_bending,
    damping_torque,
    dissipate_bending,
    shaft_element,
    spin,
    tilt_lag,
    tilt_lag_rate,
    twist_torque,
)
from .shared import DriveInputs


@dataclass
class ShaftParameters:
    """Defaults: the set `kushwaha2000`."""

    drive_ratio: float = kinds.NUMBER("cam angle over drive angle (0.5 behind a four-stroke crankshaft)", 1.0)
    phase: float = kinds.PHASE("cam angle at drive angle zero; the nose is at pi")
    flexible: float = kinds.SWITCH("the shaft bends and twists; false: rigid")
    mass: float = kinds.PART_MASS("mass at the cam", 0.425, nominal=0.4, positive=True)
    polar_inertia: float = kinds.INERTIA("moment of inertia about the shaft", 3.00e-4)
    transverse_inertia: float = kinds.INERTIA("moment of inertia about a diameter", 1.42e-4)
    shaft_length: float = kinds.LENGTH("length l of the field element", 0.1)
    shaft_diameter: float = kinds.DIAMETER("diameter of the shaft", 0.02)
    youngs_modulus: float = kinds.YOUNGS_MODULUS("Young's modulus of the shaft", 207e9)
    poissons_ratio: float = kinds.NUMBER("Poisson's ratio of the shaft", 0.3, minimum=0.0, maximum=0.5)
    shaft_damping_ratio: float = kinds.DAMPING_RATIO(
        "damping ratio of every mode of the shaft", 0.02, maximum=1.0
    )


@dataclass
class CamshaftState:
    """All stay at zero when the shaft is rigid."""

    twist: float = kinds.ANGLE("cam angle less driven angle", nominal=1e-4)
    twist_rate: float = kinds.ROTATION_RATE("rate of twist", nominal=1.0)
    bending: float = kinds.PLACE(
        "cam axis displacement towards the follower", nominal=1e-4, display_unit="mm"
    )
    bending_rate: float = kinds.VELOCITY("cam axis velocity towards the follower", nominal=0.1)
    slope: float = kinds.TILT("slope of the shaft at the cam")
    slope_rate: float = kinds.ROTATION_RATE("rate of the slope at the cam", nominal=1.0)
    bending_across: float = kinds.DEFLECTION(
        "cam axis displacement across the follower's path, against the cam's surface"
    )
    bending_across_rate: float = kinds.VELOCITY("its rate, the axis's drift along the follower", nominal=1e-2)
    slope_across: float = kinds.TILT("slope of the shaft at the cam across the follower's path", nominal=1e-4)
    slope_across_rate: float = kinds.ROTATION_RATE("its rate", nominal=0.1)


@dataclass
class CamshaftInputs(DriveInputs):
    contact_load: float = kinds.FORCE("load W of the follower on the cam")
    friction_force: float = kinds.FRICTION("friction on the cam against its sliding")


@dataclass
class CamshaftOutputs:
    surface_position: float = kinds.DISPLACEMENT("cam surface towards the follower, s + bending")
    surface_velocity: float = kinds.VELOCITY("velocity of the cam surface towards the follower")
    radius_of_curvature: float = kinds.DISTANCE("radius of the cam at the contact")
    entraining_velocity: float = kinds.VELOCITY("mean surface velocity relative to the contact")
    sliding_velocity: float = kinds.VELOCITY("velocity of cam over follower surface")
    drive_torque: float = kinds.TORQUE("torque taken from the drive")
    cam_angle: float = kinds.ANGLE("angle of the cam; the nose is at pi")
    cam_speed: float = kinds.SPEED("speed of the cam")
    cam_lift: float = kinds.DISPLACEMENT("lift s of the profile")
    contact_offset: float = kinds.DISTANCE("offset of the contact along the follower, s' + bending across")
    next_event: float = kinds.TIME(
        "time at which the cam next reaches a jump of s''' (jerk); 1e30 if it rests", NO_EVENT
    )


@kernel
def cam_angle(x: CamshaftState, u: CamshaftInputs, p: ShaftParameters) -> float:
    """psi = ratio * drive angle + phase + twist (wind-up), less what the tilt takes."""
    return p.drive_ratio * u.drive_angle + p.phase + x.twist - tilt_lag(x)


@kernel
def cam_speed(x: CamshaftState, u: CamshaftInputs, p: ShaftParameters) -> float:
    """psi' = ratio * drive speed + twist rate, less what the tilt takes."""
    return p.drive_ratio * u.drive_speed + x.twist_rate - tilt_lag_rate(x)


@kernel
def load_torque(cam: Lift, u: CamshaftInputs, p: Any) -> float:
    """Torque of the contact against the rotation: W s' + F (R0 + s)."""
    return u.contact_load * cam.ds + u.friction_force * (p.base_radius + cam.s)


@kernel
def twist_acceleration(cam: Lift, e: Shaft, x: CamshaftState, u: CamshaftInputs, p: Any) -> float:
    """I (theta'' + psi_d'') = -k theta - c theta' - W s' ..., of a cam that does not tilt."""
    return (
        -(twist_torque(e, x) + load_torque(cam, u, p)) / p.polar_inertia
        - p.drive_ratio * u.drive_acceleration
    )


@kernel
def move_shaft(cam: Lift, x: CamshaftState, u: CamshaftInputs, p: Any, dx: CamshaftState) -> None:
    """Twist by W s', bending by W and, across the follower's path, by friction: I spin' = -k theta - ..."""
    if p.flexible == 0.0:
        dx.twist = dx.twist_rate = dx.bending = dx.bending_rate = dx.slope = dx.slope_rate = 0.0
        dx.bending_across = dx.bending_across_rate = dx.slope_across = dx.slope_across_rate = 0.0
        return
    e, load = shaft_element(p), Load(-u.contact_load, u.friction_force, load_torque(cam, u, p))
    bend_shaft(e, x, load, p.drive_ratio * u.drive_speed, p, dx)
    dx.twist = x.twist_rate
    tilting = 0.5 * (x.slope_across * dx.slope_rate - x.slope * dx.slope_across_rate)
    dx.twist_rate = twist_acceleration(cam, e, x, u, p) + tilting


@kernel
def show_surface(cam: Lift, x: CamshaftState, u: CamshaftInputs, p: Any, y: CamshaftOutputs) -> None:
    """All outputs but the next event.

    The axis's velocity w across the follower's path adds w/2 to the entraining velocity and takes w from the
    sliding velocity (K, section 5: fictitious velocity).
    """
    speed, drift = cam_speed(x, u, p), x.bending_across_rate
    y.cam_angle = cam_angle(x, u, p)
    y.cam_speed = speed
    y.cam_lift = cam.s
    y.contact_offset = cam.ds + x.bending_across
    y.surface_position = cam.s + x.bending
    y.surface_velocity = cam.ds * speed + x.bending_rate
    y.radius_of_curvature = radius_of_curvature(p.base_radius, cam)
    y.entraining_velocity = entraining_velocity(p.base_radius, cam, speed) + 0.5 * drift
    y.sliding_velocity = sliding_velocity(p.base_radius, cam, speed) - drift
    if p.flexible == 0.0:
        inertia_torque = p.polar_inertia * p.drive_ratio * u.drive_acceleration
        y.drive_torque = p.drive_ratio * (inertia_torque + load_torque(cam, u, p))
    else:
        e = shaft_element(p)
        damped = damp_bending(e, x, p.drive_ratio * u.drive_speed)
        y.drive_torque = p.drive_ratio * (damping_torque(damped, x) - twist_torque(e, x))


@kernel
def energy(t: float, x: CamshaftState, u: CamshaftInputs, p: ShaftParameters, e: Vector) -> None:
    s, turning = shaft_element(p), p.drive_ratio * u.drive_speed
    stored = s.twist_stiffness * x.twist**2 + p.polar_inertia * spin(x, turning) ** 2
    stored += bending_energy(s, x.bending, x.slope) + bending_energy(s, x.bending_across, x.slope_across)
    stored += p.mass * (x.bending_rate**2 + x.bending_across_rate**2)
    stored += p.transverse_inertia * (x.slope_rate**2 + x.slope_across_rate**2)
    e[0] = 0.5 * stored
    e[1] = s.twist_damping * x.twist_rate**2 + dissipate_bending(damp_bending(s, x, turning), x, turning)
    e[2] = 0.0


def make_next_event(profile: CamProfile) -> Any:
    """A kernel (cam, t, x, u, p) -> the time at which the profile breaks next.

    By angle, speed and acceleration of the drive, and of a flexible shaft by the twist as it is; within a
    radian of the twist's own oscillation also by its rate and acceleration.
    """
    find_breaks = profile.find_breaks

    @kernel
    def next_event(cam: Lift, t: float, x: CamshaftState, u: CamshaftInputs, p: Any) -> float:
        breaks = find_breaks(cam_angle(x, u, p), p)
        speed, acceleration = p.drive_ratio * u.drive_speed, p.drive_ratio * u.drive_acceleration
        wait = time_to_break(breaks, speed, acceleration)
        if p.flexible != 0.0:
            e = shaft_element(p)
            if wait < math.sqrt(p.polar_inertia / e.twist_stiffness):
                acceleration += twist_acceleration(cam, e, x, u, p)
                wait = time_to_break(breaks, cam_speed(x, u, p), acceleration)
        return min(t + wait, NO_EVENT)

    return next_event


def make_motion(profile: CamProfile) -> tuple[Any, Any]:
    """The kernels `derivative` and `output` of a camshaft with this profile."""
    lift, next_event = profile.lift, make_next_event(profile)

    @kernel
    def derivative(t: float, x: CamshaftState, u: CamshaftInputs, p: Any, dx: CamshaftState) -> None:
        move_shaft(lift(cam_angle(x, u, p), p), x, u, p, dx)

    @kernel
    def output(t: float, x: CamshaftState, u: CamshaftInputs, p: Any, y: CamshaftOutputs) -> None:
        cam = lift(cam_angle(x, u, p), p)
        show_surface(cam, x, u, p, y)
        y.next_event = next_event(cam, t, x, u, p)

    return derivative, output


def camshaft(table_points: int = 0) -> Component:
    """One cam on its shaft element: by a law, or through `table_points` points."""
    profile, parameters = choose_profile(table_points, ShaftParameters)
    sizes = {"table_points": table_points}
    derivative, output = make_motion(profile)
    records = layouts(parameters, CamshaftState, CamshaftInputs, CamshaftOutputs, sizes)
    inputs = records["inputs"].names
    angle, speed = ("drive_angle",), ("drive_angle", "drive_speed")
    return Component(
        tolerance=FINE_TOLERANCE,
        name="camshaft",
        description="Cam for a flat follower on a rigid or flexible shaft",
        roles=(
            roles.Cam("cam_angle", "radius_of_curvature", "drive_torque"),
            roles.TwistedCam(),
            roles.FlatFollower(),
        ),
        **records,
        derivative=derivative,
        output=output,
        energy=energy,
        feedthrough={
            "surface_position": angle,
            "surface_velocity": speed,
            "radius_of_curvature": angle,
            "entraining_velocity": speed,
            "sliding_velocity": speed,
            "drive_torque": inputs,
            "cam_angle": angle,
            "cam_speed": ("drive_speed",),
            "cam_lift": angle,
            "contact_offset": angle,
            "next_event": inputs,
        },
        bonds=(
            PowerBond("drive_torque", "drive_speed", +1),
            PowerBond("contact_load", "surface_velocity", -1),
            PowerBond("friction_force", "sliding_velocity", -1),
        ),
        requirements=(*profile.requirements, require_convexity(profile)),
        structure=sizes,
        # Where the entrainment reverses, film formulas have a kink: they know |u|.
        event_indicators=("entraining_velocity",),
        next_event="next_event",
    )
