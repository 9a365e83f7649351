"""Axial profiles: the relief z(y) >= 0 of a roller's surface, y from the middle of its length.

Lundberg (1939): the elastic surface of a half-space under the pressure of an evenly loaded line contact,
z = A ln[1 / (1 - (2y/L)^2)], A = W compliance / (pi L), so that pressing it flat takes that pressure. It is
infinite at the ends; Johns and Gohar (1981) end it at a finite drop, with 1 - 0.3033 b/a as a factor of
(2y/L)^2, a = L/2. With a straight middle it is the dub-off of Fujiwara and Kawase (2007).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from ....core.quantities import Vector
from ...hertz import half_width
from .faults import out_of_range, require_not_negative, require_positive

# Johns and Gohar's number, of their formula for the drop at the end.
_JOHNS_GOHAR = 0.3033


class Profile(Protocol):
    def drop(self, y: Vector, length: float) -> Vector:
        """Relief (m) at y (m, |y| < length/2)."""
        ...

    def kinks(self, length: float) -> tuple[float, ...]:
        """The y in (0, length/2) where the slope of the relief jumps: the pressure peaks there."""
        ...


@dataclass(frozen=True)
class Straight:
    """No relief: sharp ends."""

    def drop(self, y: Vector, length: float) -> Vector:
        return np.zeros_like(y)

    def kinks(self, length: float) -> tuple[float, ...]:
        return ()


@dataclass(frozen=True)
class Crowned:
    """A circular arc of `radius` (m) over the whole length: z = r - sqrt(r^2 - y^2)."""

    radius: float

    def __post_init__(self) -> None:
        require_positive("crown radius", self.radius, "m", "use Straight for no crown")

    def drop(self, y: Vector, length: float) -> Vector:
        if self.radius < 0.5 * length:
            raise out_of_range(
                "crown radius", self.radius, "m", f">= length/2 = {0.5 * length:g} m", "increase it"
            )
        return y**2 / (self.radius + np.sqrt(self.radius**2 - y**2))

    def kinks(self, length: float) -> tuple[float, ...]:
        return ()


@dataclass(frozen=True)
class Chamfered:
    """Straight, but for the last `width` (m) at either end, which falls off by `slope` (1)."""

    width: float
    slope: float

    def __post_init__(self) -> None:
        require_positive("chamfer width", self.width, "m", "use Straight for no chamfer")
        require_positive("chamfer slope", self.slope, "1", "use Straight for no chamfer")

    def drop(self, y: Vector, length: float) -> Vector:
        return self.slope * np.maximum(np.abs(y) - self.kinks(length)[0], 0.0)

    def kinks(self, length: float) -> tuple[float, ...]:
        if self.width >= 0.5 * length:
            bound = f"< length/2 = {0.5 * length:g} m"
            raise out_of_range("chamfer width", self.width, "m", bound, "make the chamfer narrower")
        return (0.5 * length - self.width,)


@dataclass(frozen=True)
class Logarithmic:
    """z = A ln[1 / (1 - (1 - exp(-e/A)) s^2)], s from 0 at the end of the straight part to 1.

    `amplitude` A (m), `end_drop` e (m, infinite: Lundberg's), `straight_share` of the length in the middle.
    """

    amplitude: float
    end_drop: float = math.inf
    straight_share: float = 0.0

    def __post_init__(self) -> None:
        require_positive("amplitude of the logarithmic profile", self.amplitude, "m", "use Straight for none")
        require_positive("end drop of the logarithmic profile", self.end_drop, "m", "use Straight for none")
        require_not_negative(
            "straight share", self.straight_share, "1", "use 0 for a profile over the whole length"
        )
        if self.straight_share >= 1.0:
            raise out_of_range(
                "straight share", self.straight_share, "1", "< 1", "use Straight for no relief"
            )

    def drop(self, y: Vector, length: float) -> Vector:
        straight = 0.5 * length * self.straight_share
        s = np.maximum(np.abs(y) - straight, 0.0) / (0.5 * length - straight)
        return -self.amplitude * np.log1p(np.expm1(-self.end_drop / self.amplitude) * s**2)

    def kinks(self, length: float) -> tuple[float, ...]:
        return ()


def lundberg(load: float, length: float, compliance: float) -> Logarithmic:
    """Lundberg's profile for an even axial load at `load` (N); compliance in 1/Pa (see hertz)."""
    require_positive("design load", load, "N", "give the load at which the axial load is to be even")
    return Logarithmic(load * compliance / (math.pi * length))


def johns_gohar(load: float, radius: float, length: float, compliance: float) -> Logarithmic:
    """Johns and Gohar's profile for `load` (N) and the roller's reduced radius (m)."""
    amplitude = lundberg(load, length, compliance).amplitude
    end = _JOHNS_GOHAR * half_width(load, radius, length, compliance) / (0.5 * length)
    if end >= 1.0:
        bound = f"such that 0.3033 b/a = {end:.3g} < 1"
        raise out_of_range("design load", load, "N", bound, "the contact is wider than long: reduce the load")
    return Logarithmic(amplitude, -amplitude * math.log(end))
