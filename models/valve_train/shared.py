"""Quantities and inputs that several parts of a train declare alike."""

from dataclasses import dataclass
from typing import Annotated

from ..core.quantities import Quantity
from ..plausible import SURGE_FREQUENCY

SurgeFrequency = Annotated[
    float,
    Quantity(
        "Hz", "first natural frequency f0 of the clamped spring", nominal=500.0, positive=True,
        plausible=SURGE_FREQUENCY,
    ),
]  # fmt: skip
SurgeDamping = Annotated[
    float,
    Quantity("1", "damping ratio of the spring at f0 (stiffness-proportional)", nominal=0.01, minimum=0.0),
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

    drive_angle: float = Quantity("rad", "angle of the drive", display_unit="deg").default()
    drive_speed: float = Quantity("rad/s", "speed of the drive", nominal=100.0, display_unit="rpm").default()
    drive_acceleration: float = Quantity(
        "rad/s2", "angular acceleration of the drive", nominal=100.0
    ).default()


@dataclass
class EndMotions:
    """Motions of the bodies at both ends of a rod or a lash adjuster."""

    lower_position: float = Quantity(
        "m", "position of the body below", nominal=1e-3, display_unit="mm"
    ).default()
    lower_velocity: float = Quantity("m/s", "velocity of the body below").default()
    upper_position: float = Quantity(
        "m", "position of the body above", nominal=1e-3, display_unit="mm"
    ).default()
    upper_velocity: float = Quantity("m/s", "velocity of the body above").default()
