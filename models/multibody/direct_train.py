"""The valve train of Kushwaha et al. 2000 (K), sections 2 and 4, as a mechanism."""

from typing import Any

from ..valve_train.cams.law import LAW
from ..valve_train.cams.profile import CamProfile
from .bodies import GROUND
from .forces import ContactSpring
from .joints import plane_contact
from .mechanism import Mechanism
from .train_parts import BEARING, CONTACT, DRIVE, GUIDE, TrainStart, list_parts

__all__ = ["BEARING", "CONTACT", "DRIVE", "GUIDE", "SEAT", "TrainStart", "direct_train"]

SEAT = "seat"


def direct_train(
    camshaft: Any,
    valve: Any,
    speed: float,
    *,
    coil_masses: int = 2,
    lubricant: Any = None,
    profile: CamProfile = LAW,
    start: TrainStart | None = None,
) -> Mechanism:
    """K's train from the parameters of `camshaft` and `valve_spring`, at a cam speed (rad/s).

    The follower stays on the cam, or, with the parameters of an `ehl_contact` as `lubricant`, rides on its
    oil film. A valve with the stiffness of a seat may sit on it. Gas force is left out.
    """
    parts = list_parts(camshaft, valve, speed, coil_masses=coil_masses, lubricant=lubricant, start=start)
    if valve.seat_stiffness > 0.0:
        at_rest = (0.0, float(camshaft.base_radius + valve.lash), float(camshaft.shaft_length))
        seat = plane_contact(SEAT, GROUND, "follower", at_i=at_rest)
        parts.forces.append(ContactSpring(seat, valve.seat_stiffness, valve.seat_damping))
    return Mechanism(parts.bodies, parts.joints, parts.forces, profile=profile)
