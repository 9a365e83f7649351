"""What is asked: the contact and the instant at which it runs."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from ....core.quantities import Vector
from ...fluid import Lubricant
from .faults import out_of_range, require_finite, require_not_negative, require_positive
from .profiles import Profile, Straight

# Larger slopes than this (rad) are no misalignment of a contact: sin and tan would have to be told apart.
_LARGEST_MISALIGNMENT = 0.05


@dataclass(frozen=True)
class FiniteLine:
    """The parts: `length` L (m), `compliance` (1/Pa, see hertz), lubricant and axial profile."""

    length: float
    compliance: float
    fluid: Lubricant
    profile: Profile = field(default_factory=Straight)

    def __post_init__(self) -> None:
        require_positive("length", self.length, "m", "give the length of the contact")
        require_positive("compliance", self.compliance, "1/Pa", "see hertz.elastic_compliance")
        require_positive("viscosity", self.fluid.viscosity, "Pa s", "use `dry` for no lubricant")
        require_not_negative(
            "pressure-viscosity coefficient", self.fluid.pressure_viscosity, "1/Pa", "0 is isoviscous"
        )
        if self.fluid.eyring_stress != 0.0:
            remedy = "shear thinning is in the line contact only"
            raise out_of_range("Eyring stress", self.fluid.eyring_stress, "Pa", "0 (Newtonian)", remedy)


@dataclass(frozen=True)
class Running:
    """An instant: `load` W (N), mean surface velocity u (m/s, its sign is its direction along x), reduced
    radius R (m) and `misalignment` (rad: the gap opens towards +y by so much)."""

    load: float
    velocity: float
    radius: float
    misalignment: float = 0.0

    def __post_init__(self) -> None:
        require_positive("load", self.load, "N", "an open contact has no film to solve for")
        require_finite("load", self.load, "N", "give a load")
        require_finite("entraining velocity", self.velocity, "m/s", "give a velocity")
        require_positive("radius", self.radius, "m", "give the reduced radius of the contact")
        if not abs(self.misalignment) <= _LARGEST_MISALIGNMENT:
            bound = f"between -{_LARGEST_MISALIGNMENT} and {_LARGEST_MISALIGNMENT} rad"
            raise out_of_range("misalignment", self.misalignment, "rad", bound, "give a slope, not degrees")

    def relief(self, contact: FiniteLine, y: Vector) -> Vector:
        """Distance (m) of the surfaces along the line x = 0, before load, less its smallest value."""
        drop = contact.profile.drop(y, contact.length) + self.misalignment * y
        return drop - np.min(drop)
