"""Rigid bodies, the axes in which joints are drawn, and the ranges of what mechanisms are made of."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from ..core.errors import ModelError
from ..core.quantities import Vector

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


class Allowed(NamedTuple):
    """From `low`, which is allowed itself if `with_low`, to `high`."""

    low: float
    high: float
    unit: str
    with_low: bool = False

    def holds(self, number: float) -> bool:
        above = number >= self.low if self.with_low else number > self.low
        return above and number <= self.high and math.isfinite(number)

    def __str__(self) -> str:
        limit = f"not above {self.high:g}" if math.isfinite(self.high) else "finite"
        return f"{'from' if self.with_low else 'above'} {self.low:g} and {limit} {self.unit}".rstrip()


# Wide enough for any machine, narrow enough to find values in mm, MPa, GPa or t/m3.
RANGES = {
    "length": Allowed(0.0, 100.0, "m"),
    "diameter": Allowed(0.0, 10.0, "m"),
    "area": Allowed(0.0, 100.0, "m2"),
    "arm": Allowed(0.0, 100.0, "m"),
    "radius": Allowed(0.0, 100.0, "m", with_low=True),
    "film": Allowed(0.0, 1e-2, "m"),
    "mass": Allowed(0.0, math.inf, "kg", with_low=True),
    "youngs_modulus": Allowed(1e5, 1e13, "Pa"),
    "poissons_ratio": Allowed(-1.0, 0.5, ""),
    "density": Allowed(10.0, 1e5, "kg/m3"),
    "shear_factor": Allowed(0.0, 10.0, "", with_low=True),
    "damping_time": Allowed(0.0, 1.0, "s", with_low=True),
    "damping_ratio": Allowed(0.0, 10.0, "", with_low=True),
    "stiffness": Allowed(0.0, math.inf, "N/m", with_low=True),
    "damping": Allowed(0.0, math.inf, "N s/m", with_low=True),
    "free_length": Allowed(-100.0, 100.0, "m"),
    "tilt": Allowed(-0.5 * math.pi, 0.5 * math.pi, "rad"),
}


def check_values(thing: str, **values: float) -> None:
    """ModelError for the first value that is no finite number in its range."""
    for name, value in values.items():
        allowed = RANGES[name]
        if not allowed.holds(value):
            shown = f"{value:g} {allowed.unit}".rstrip()
            raise ModelError(f"{thing}: {name} = {shown}: must be {allowed}; give it in SI units")
