"""The valve train of Kushwaha et al. 2000 (K), sections 2 and 4, as a mechanism.

Parts and joints are K's Tables 1 and 2; the axes are z along the shaft and y along the valve. Five moving
parts have 30 coordinates; 4 (cylindrical), 1 (drive), 15 (translational) and 1 (contact) are K's 21
constraints. On a rigid shaft a fixed joint holds the cam with 6 more.
"""

import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from ..valve_train.cams.law import LAW
from ..valve_train.cams.profile import CamProfile
from .bodies import GROUND, Body, Y
from .coils import hang_coils
from .fill import Force
from .forces import ALONG_SHAFT, ContactSpring, ElasticField, LubricatedCam, beam_stiffness, modal_damping
from .joints import cylindrical, fixed, flat_cam, plane_contact, prescribed_rotation, translational
from .mechanism import Mechanism

# K Table 1, middle of the ranges: mass (kg) and moments of inertia (kg m^2) of what the load does not move.
SHAFT_MASS, SHAFT_INERTIA = 0.175, (62.5e-6, 62.5e-6, 125e-6)  # about z: twice, as a disc (K: 185e-6)
FOLLOWER_INERTIA = (204e-6, 37.5e-6, 204e-6)

BEARING, DRIVE, CONTACT, GUIDE, SEAT = "bearing", "drive", "contact", "guide", "seat"


def direct_train(
    parts: Mapping[str, Any],
    states: Mapping[str, Any],
    speed: float,
    coil_masses: int = 2,
    profile: CamProfile = LAW,
) -> Mechanism:
    """K's train at a cam speed (rad/s), from the parameters and states of its components.

    `parts` has those of `camshaft` and `valve_spring`. The follower stays on the cam, or, with the `contact`
    of an `ehl_contact`, rides on its oil film. A valve with the stiffness of a seat may sit on it. Gas force
    is left out.
    """
    camshaft, valve = parts["camshaft"], parts["valve_spring"]
    angle = float(camshaft.drive_ratio * states["flywheel"].angle)
    length = float(camshaft.shaft_length)
    closed = 0.0, float(camshaft.base_radius + valve.lash), length
    coils = hang_coils(
        valve, "follower", [f"spring mass {i + 5}" for i in range(coil_masses)],
        closed, Y, states["valve_spring"].coil_position,
    )  # fmt: skip
    joints = [
        cylindrical(BEARING, GROUND, "shaft"),
        prescribed_rotation(DRIVE, GROUND, "shaft", speed, angle),
        translational(GUIDE, GROUND, "follower", at_i=(0.0, 0.0, length)),
        *coils.guides,
    ]
    forces: list[Force] = [*coils.springs]
    # Where the cam's angle is zero: it is `phase` along y.
    foot = -math.sin(camshaft.phase), math.cos(camshaft.phase), 0.0
    contact = flat_cam(CONTACT, "cam", "follower", camshaft, foot=foot)
    if "contact" in parts:
        forces.append(LubricatedCam(contact, parts["contact"], float(states["contact"].film_thickness)))
    else:
        joints.insert(2, contact)
    if camshaft.flexible:
        forces.append(_make_shaft(camshaft))
    else:
        joints.append(fixed("shaft and cam", "shaft", "cam", at_i=(0.0, 0.0, length)))
    if valve.seat_stiffness > 0.0:
        seat = plane_contact(SEAT, GROUND, "follower", at_i=closed)
        forces.append(ContactSpring(seat, valve.seat_stiffness, valve.seat_damping))
    bodies = [*_list_bodies(camshaft, valve, speed, angle, states), *coils.bodies]
    return Mechanism(bodies, joints, forces, profile=profile)


def _list_bodies(
    camshaft: Any, valve: Any, speed: float, angle: float, states: Mapping[str, Any]
) -> list[Body]:
    shaft, position = states["camshaft"], float(states["valve_spring"].position)
    base, length = float(camshaft.base_radius), float(camshaft.shaft_length)
    transverse, polar = float(camshaft.transverse_inertia), float(camshaft.polar_inertia)
    slope, slope_across = float(shaft.slope), float(shaft.slope_across)
    across, along = math.sin(slope_across), math.cos(slope_across)
    # A cam at rest on a bent shaft turns about its own axis.
    axis = across, along * math.sin(slope), along * math.cos(slope)
    return [
        Body(
            "shaft", SHAFT_MASS, SHAFT_INERTIA, angles=(0.0, 0.0, angle),
            angular_velocity=(0.0, 0.0, speed),
        ),
        Body(
            "cam", float(camshaft.mass), (transverse, transverse, polar),
            (float(shaft.bending_across), float(shaft.bending), length),
            (-slope, slope_across, angle + float(shaft.twist)),
            angular_velocity=(speed * axis[0], speed * axis[1], speed * axis[2]),
        ),
        Body("follower", float(valve.valve_mass), FOLLOWER_INERTIA, (0.0, base + position, length)),
    ]  # fmt: skip


def _make_shaft(camshaft: Any) -> ElasticField:
    """K (33) between the driven end and the cam, every mode damped alike."""
    stiffness = beam_stiffness(
        camshaft.shaft_length, camshaft.shaft_diameter, camshaft.youngs_modulus, camshaft.poissons_ratio
    )
    turning = [camshaft.polar_inertia, camshaft.transverse_inertia, camshaft.transverse_inertia]
    masses = np.array([*3 * [camshaft.mass], *turning], float)
    damping = modal_damping(stiffness, masses, camshaft.shaft_damping_ratio)
    rest = (float(camshaft.shaft_length), 0.0, 0.0)
    return ElasticField("shaft", "cam", stiffness, damping, rest, axes_i=ALONG_SHAFT, axes_j=ALONG_SHAFT)
