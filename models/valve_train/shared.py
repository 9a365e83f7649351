"""Quantities and inputs that several parts of a train declare alike."""

from dataclasses import dataclass
from typing import Annotated

from .. import kinds
from ..core.quantities import Quantity
from ..plausible import SURGE_FREQUENCY

# Stiffness (N/m) of coils that touch, where a spring states none.
CLOSED_COILS = 5e6

SurgeFrequency = Annotated[
    float,
    Quantity(
        "Hz", "first natural frequency f0 of the clamped spring", nominal=500.0, positive=True,
        plausible=SURGE_FREQUENCY,
    ),
]  # fmt: skip
SurgeDamping = Annotated[
    float, kinds.DAMPING_RATIO.of("damping ratio of the spring at f0 (stiffness-proportional)")
]

WireStress = Annotated[
    float,
    Quantity(
        "1/m2", "largest shear stress in the wire over the force; 0: not known", nominal=1e6, minimum=0.0
    ),
]
WireAmplitude = Annotated[
    float,
    Quantity("Pa", "amplitude of shear stress that the wire bears at no mean", nominal=5e8, minimum=0.0),
]
WireStrength = Annotated[float, Quantity("Pa", "shear strength of the wire", nominal=1e9, minimum=0.0)]


@dataclass
class DriveInputs:
    """Motion of what drives a shaft."""

    drive_angle: float = kinds.ANGLE("angle of the drive")
    drive_speed: float = kinds.SPEED("speed of the drive")
    drive_acceleration: float = kinds.ANGULAR_ACCELERATION("angular acceleration of the drive")


@dataclass
class EndMotions:
    """Motions of the bodies at both ends of a rod or a lash adjuster."""

    lower_position: float = kinds.DISPLACEMENT("position of the body below")
    lower_velocity: float = kinds.VELOCITY("velocity of the body below")
    upper_position: float = kinds.DISPLACEMENT("position of the body above")
    upper_velocity: float = kinds.VELOCITY("velocity of the body above")
