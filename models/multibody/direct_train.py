"""The valve train of Kushwaha et al. 2000 (K), sections 2 and 4: shaft, cam, follower and two spring masses.

Parts and joints are K's Tables 1 and 2; the axes are z along the shaft and y along the valve. Five moving
parts have 30 coordinates; 4 (cylindrical), 1 (drive), 15 (translational) and 1 (contact) are K's 21
constraints. On a rigid shaft a fixed joint holds the cam with 6 more.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from ..valve_train.cams.law import LAW
from ..valve_train.cams.profile import CamProfile
from ..valve_train.valve_spring import lumping
from .bodies import GROUND, Body
from .forces import ElasticField, SpringDamper, beam_stiffness, modal_damping
from .joints import cylindrical, fixed, flat_cam, prescribed_rotation, translational
from .mechanism import Mechanism

# K Table 1, middle of the ranges: mass (kg) and moments of inertia (kg m^2) of what the load does not move.
SHAFT_MASS, SHAFT_INERTIA = 0.175, (62.5e-6, 62.5e-6, 125e-6)  # about z: twice, as a disc (K: 185e-6)
FOLLOWER_INERTIA = (204e-6, 37.5e-6, 204e-6)
COIL_INERTIA = (11.25e-9, 11.25e-9, 11.25e-9)
# Length of the installed spring (m). Forces along the guide do not depend on it.
SPRING_LENGTH = 0.04
# Axes of the shaft element: x of K (33) along the shaft.
ALONG_SHAFT = np.array([[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]])

BEARING, DRIVE, CONTACT, GUIDE = "bearing", "drive", "contact", "guide"


def direct_train(
    camshaft: Any, valve: Any, speed: float, coil_masses: int = 2, profile: CamProfile = LAW
) -> Mechanism:
    """K's train from the parameters of `camshaft` and `valve_spring`, at a cam speed (rad/s).

    The seat and gas forces are left out; the follower stays on the cam.
    """
    base, length = float(camshaft.base_radius), float(camshaft.shaft_length)
    heights = base + SPRING_LENGTH * np.arange(coil_masses + 2) / (coil_masses + 1)
    coils = [f"spring mass {i + 5}" for i in range(coil_masses)]
    share = lumping(coil_masses)
    coil_mass = share.mass * valve.spring_rate / (math.pi * valve.surge_frequency) ** 2
    transverse, polar = float(camshaft.transverse_inertia), float(camshaft.polar_inertia)
    bodies = [
        Body("shaft", SHAFT_MASS, SHAFT_INERTIA),
        Body("cam", float(camshaft.mass), (transverse, transverse, polar), (0.0, 0.0, length)),
        Body("follower", float(valve.valve_mass), FOLLOWER_INERTIA, (0.0, base, length)),
        *(
            Body(name, coil_mass, COIL_INERTIA, (0.0, y, length))
            for name, y in zip(coils, heights[1:-1], strict=True)
        ),
    ]
    joints = [
        cylindrical(BEARING, GROUND, "shaft"),
        prescribed_rotation(DRIVE, GROUND, "shaft", speed),
        flat_cam(CONTACT, "cam", "follower", camshaft, foot=_find_foot(camshaft)),
        translational(GUIDE, GROUND, "follower", at_i=(0.0, 0.0, length)),
        *(translational(f"guide of {name}", GROUND, name, at_i=(0.0, 0.0, length)) for name in coils),
    ]
    chain = ["follower", *coils, GROUND]
    rates = [share.end_rate, *[share.inner_rate] * (coil_masses - 1), share.end_rate]
    forces: list[Any] = [
        _make_coil(
            lower,
            upper,
            r * float(valve.spring_rate),
            valve,
            float(heights[1] - base),
            float(heights[-1]),
            length,
        )
        for lower, upper, r in zip(chain[:-1], chain[1:], rates, strict=True)
    ]
    if camshaft.flexible:
        forces.append(_make_shaft(camshaft, (float(camshaft.mass),) * 3 + (polar, transverse, transverse)))
    else:
        joints.append(fixed("shaft and cam", "shaft", "cam", at_i=(0.0, 0.0, length)))
    return Mechanism(bodies, joints, forces, profile=profile)


def _find_foot(camshaft: Any) -> tuple[float, float, float]:
    """Where the cam's angle is zero: it is `phase` along y."""
    return -math.sin(camshaft.phase), math.cos(camshaft.phase), 0.0


def _make_coil(
    lower: str, upper: str, rate: float, valve: Any, installed: float, head: float, z: float
) -> SpringDamper:
    """A segment of the spring, which carries the preload at its installed length."""
    damping = valve.damping_ratio / (math.pi * valve.surge_frequency) * rate
    end = (0.0, head, z) if upper == GROUND else (0.0, 0.0, 0.0)
    return SpringDamper(lower, upper, rate, installed + valve.preload / rate, damping, at_j=end)


def _make_shaft(camshaft: Any, masses: tuple[float, ...]) -> ElasticField:
    """K (33) between the driven end and the cam, every mode damped alike."""
    stiffness = beam_stiffness(
        camshaft.shaft_length, camshaft.shaft_diameter, camshaft.youngs_modulus, camshaft.poissons_ratio
    )
    damping = modal_damping(stiffness, np.array(masses), camshaft.shaft_damping_ratio)
    rest = (float(camshaft.shaft_length), 0.0, 0.0)
    return ElasticField("shaft", "cam", stiffness, damping, rest, axes_i=ALONG_SHAFT, axes_j=ALONG_SHAFT)
