"""Rigid bodies, the axes in which joints are drawn, and the ranges of what mechanisms are made of."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ..core.errors import ModelError
from ..core.quantities import Quantity, Vector

Point = Sequence[float]
ORIGIN = (0.0, 0.0, 0.0)
X, Y, Z = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)
GROUND = "ground"


@dataclass(frozen=True)
class Body:
    """A rigid body whose axes are the principal ones of its inertia (kg m^2) at its centre of mass.

    The start is a guess of where it stands: the joints move it to where they hold. Its orientation is
    R_x(alpha) R_y(beta) R_z(gamma), Cardan angles 1-2-3 (rad); they have no rates at beta = +-90 deg. The
    applied `moment` (N m, axes of the ground) is constant.
    """

    name: str
    mass: float
    inertia: Point
    position: Point = ORIGIN
    angles: Point = ORIGIN
    velocity: Point = ORIGIN
    angular_velocity: Point = ORIGIN
    moment: Point = ORIGIN

    def __post_init__(self) -> None:
        """ModelError unless mass and inertia are positive. K's Table 1 has inertias that no body can have."""
        inertia = np.asarray(self.inertia, float)
        positive = inertia.shape == (3,) and np.all((inertia > 0.0) & np.isfinite(inertia))
        if not (positive and 0.0 < self.mass < np.inf):
            raise ModelError(
                f"body {self.name}: mass = {self.mass:g} kg and inertia = {list(self.inertia)} kg m2 "
                "must be positive and finite"
            )
        for field in ("position", "angles", "velocity", "angular_velocity", "moment"):
            check_vector(f"body {self.name}: {field}", getattr(self, field))


def check_vector(name: str, vector: Point) -> Vector:
    """The vector as an array; ModelError unless it has three finite numbers."""
    try:
        found = np.asarray(vector, float)
    except (TypeError, ValueError):
        found = np.zeros(0)
    if found.shape != (3,) or not np.all(np.isfinite(found)):
        raise ModelError(f"{name} = {vector!r}: must be three finite numbers")
    return found


def find_direction(axis: Point) -> Vector:
    """The unit vector along an axis; ModelError for one without a direction."""
    found = check_vector("axis or normal", axis)
    if not (length := float(np.linalg.norm(found))) > 0.0:
        raise ModelError(f"axis or normal = {axis!r}: has no direction")
    return np.asarray(found / length)


def make_axes(axis: Point) -> Vector:
    """Three axes as rows, right-handed: two perpendicular to `axis`, and `axis` itself; x, y, z for z."""
    third = find_direction(axis)
    start = np.roll(np.eye(3), 1, axis=0)[np.argmax(np.abs(third))] if third.max() > 0.0 else np.eye(3)[0]
    second = np.cross(third, start)
    if np.linalg.norm(second) < 0.1:
        second = np.cross(third, np.eye(3)[1])
    second /= np.linalg.norm(second)
    return np.array([np.cross(second, third), second, third])


# Wide enough for any machine, narrow enough to find values in mm, MPa, GPa or t/m3.
RANGES = {
    "length": Quantity("m", "between the ends", positive=True, maximum=100.0),
    "diameter": Quantity("m", "of the section", positive=True, maximum=10.0),
    "area": Quantity("m2", "of the section", positive=True, maximum=100.0),
    "arm": Quantity("m", "from the pivot", positive=True, maximum=100.0),
    "radius": Quantity("m", "of the pad", minimum=0.0, maximum=100.0),
    "film": Quantity("m", "at the start", positive=True, maximum=1e-2),
    "mass": Quantity("kg", "of the part", minimum=0.0),
    "youngs_modulus": Quantity("Pa", "of the material", minimum=1e5, maximum=1e13),
    "poissons_ratio": Quantity("1", "of the material", minimum=-0.99, maximum=0.5),
    "density": Quantity("kg/m3", "of the material", minimum=10.0, maximum=1e5),
    "shear_factor": Quantity("1", "A_y of the section", minimum=0.0, maximum=10.0),
    "damping_time": Quantity("s", "damping over stiffness", minimum=0.0, maximum=1.0),
    "damping_ratio": Quantity("1", "of each mode", minimum=0.0, maximum=10.0),
    "stiffness": Quantity("N/m", "force over change of length", minimum=0.0),
    "damping": Quantity("N.s/m", "force over velocity", minimum=0.0),
    "free_length": Quantity("m", "without force", minimum=-100.0, maximum=100.0),
    "tilt": Quantity("rad", "of the arm", minimum=-0.5 * math.pi, maximum=0.5 * math.pi),
}


def check_values(thing: str, **values: float) -> None:
    """ModelError for the first value that is no finite number in its range."""
    for name, value in values.items():
        if fault := RANGES[name].fault(name, value):
            raise ModelError(f"{thing}: {fault}; give it in SI units")
