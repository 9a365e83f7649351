"""Force elements between two bodies: springs with dampers, and elastic fields such as beams."""

import math
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from ..core.errors import ModelError
from ..core.quantities import Vector
from .bodies import ORIGIN, Point, check_values
from .joints import Joint

# Axes of an element of a shaft along z: x of K (33) and Q (2) along the shaft.
ALONG_SHAFT = np.array([[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]])


@dataclass(frozen=True)
class SpringDamper:
    """A spring and damper between a point of i and one of j (N/m, N s/m; `length` without force, m)."""

    i: str
    j: str
    stiffness: float
    length: float
    damping: float = 0.0
    at_i: Point = ORIGIN
    at_j: Point = ORIGIN

    def __post_init__(self) -> None:
        check_values(
            f"spring between {self.i} and {self.j}",
            stiffness=self.stiffness, damping=self.damping, free_length=self.length,
        )  # fmt: skip


@dataclass(frozen=True)
class Touching:
    """A contact that no joint holds; `contact` is what `flat_cam` or another contact gives."""

    contact: Joint

    @property
    def name(self) -> str:
        return self.contact.name


@dataclass(frozen=True)
class LubricatedCam(Touching):
    """A flat face on a cam with an oil film: the unilateral law of `ehl_contact` in place of a constraint.

    `lubricant` is the record of the contact's parameters, `film` the thickness (m) at the start.
    """

    lubricant: Any
    film: float = 1e-6

    def __post_init__(self) -> None:
        check_values(f"contact {self.name}", film=self.film)


@dataclass(frozen=True)
class ContactSpring(Touching):
    """A spring and damper in place of a contact's constraint: W = k C + c C', C the overlap of the bodies.

    It never pulls unless it is bonded.
    """

    stiffness: float
    damping: float = 0.0
    bonded: bool = False

    def __post_init__(self) -> None:
        check_values(f"contact {self.name}", stiffness=self.stiffness, damping=self.damping)


@dataclass(frozen=True)
class ElasticField:
    """(F, T) = -K delta - C delta' on j, in the axes of i's frame (the columns of `axes_i`), K (33), Q (2).

    `rest` is the place of j's frame in i's without force (m).
    """

    i: str
    j: str
    stiffness: Vector
    damping: Vector
    rest: Point
    at_i: Point = ORIGIN
    at_j: Point = ORIGIN
    axes_i: Vector = field(default_factory=lambda: np.eye(3))
    axes_j: Vector = field(default_factory=lambda: np.eye(3))

    def __post_init__(self) -> None:
        between = f"elastic field between {self.i} and {self.j}"
        for name, size in (("stiffness", 6), ("damping", 6), ("axes_i", 3), ("axes_j", 3)):
            matrix = np.asarray(getattr(self, name), float)
            if matrix.shape != (size, size) or not np.all(np.isfinite(matrix)):
                raise ModelError(f"{between}: {name}: must be {size} x {size} finite numbers")


def rod_rate(youngs_modulus: float, area: float, length: float) -> float:
    """Rate (N/m) between the centres of two segments of a rod: two springs k = 2 A E/L in series, Q (1)."""
    check_values("rod", youngs_modulus=youngs_modulus, area=area, length=length)
    return youngs_modulus * area / length


def beam_stiffness(
    length: float, diameter: float, youngs_modulus: float, poissons_ratio: float, shear_factor: float = 0.0
) -> Vector:
    """K (33) of a round Timoshenko beam along x, Q (2), (6, 6); without `shear_factor` that of Euler.

    P = 12 E I A_y/(G A L^2) with the shear factor A_y, 10/9 for a circle.
    """
    check_values(
        "beam", length=length, diameter=diameter, youngs_modulus=youngs_modulus,
        poissons_ratio=poissons_ratio, shear_factor=shear_factor,
    )  # fmt: skip
    area, second = math.pi * diameter**2 / 4.0, math.pi * diameter**4 / 64.0
    shear_modulus = youngs_modulus / (2.0 * (1.0 + poissons_ratio))
    bending = youngs_modulus * second
    p = 12.0 * bending * shear_factor / (shear_modulus * area * length**2)
    k = np.zeros((6, 6))
    k[0, 0] = youngs_modulus * area / length
    k[1, 1] = k[2, 2] = 12.0 * bending / (length**3 * (1.0 + p))
    k[3, 3] = 2.0 * shear_modulus * second / length
    k[4, 4] = k[5, 5] = (4.0 + p) * bending / (length * (1.0 + p))
    side = 6.0 * bending / (length**2 * (1.0 + p))
    k[1, 5] = k[5, 1] = -side
    k[2, 4] = k[4, 2] = side
    return k


def modal_damping(stiffness: Vector, masses: Vector, ratio: float) -> Vector:
    """C = 2 zeta M^1/2 (M^-1/2 K M^-1/2)^1/2 M^1/2: every mode of a body on the field has the ratio zeta.

    `masses` is the diagonal of M (6,): the mass three times, and the moments of inertia about the field's
    axes.
    """
    check_values("modal damping", damping_ratio=ratio)
    if not np.all(np.asarray(masses, float) > 0.0):
        raise ModelError(f"modal damping: masses = {list(masses)} kg or kg m2: must be positive")
    root = np.sqrt(np.asarray(masses, float))
    squares, modes = np.linalg.eigh(stiffness / np.outer(root, root))
    middle = (modes * np.sqrt(np.maximum(squares, 0.0))) @ modes.T
    return np.asarray(2.0 * ratio * middle * np.outer(root, root))
