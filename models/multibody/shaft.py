"""A shaft as rigid segments on Timoshenko beams, Q (2), with what sits on it."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ..core.errors import ModelError
from .bodies import GROUND, Body
from .forces import ALONG_SHAFT, ElasticField, beam_stiffness
from .joints import Joint, prescribed_rotation, revolute, spherical, support
from .ranges import check_values

DRIVE = "drive"


@dataclass(frozen=True)
class Disc:
    """What a segment carries: mass (kg), moments of inertia across and about the shaft (kg m^2)."""

    mass: float
    transverse: float
    polar: float

    def __post_init__(self) -> None:
        check_values("disc", mass=self.mass, transverse=self.transverse, polar=self.polar)


@dataclass(frozen=True)
class SegmentedShaft:
    """A round shaft along z whose segments stand at the `stations` (m, ascending), from one end to the other.

    A segment has the mass of the shaft up to the middle of its neighbours. Between two stands one K(L).
    `damping_time` is the damping over the stiffness (s). `discs` are at stations; A_y as in Q (2).
    """

    stations: Sequence[float]
    diameter: float
    discs: dict[float, Disc]
    youngs_modulus: float = 207e9
    poissons_ratio: float = 0.3
    density: float = 7850.0
    shear_factor: float = 10.0 / 9.0
    damping_time: float = 0.0
    name: str = "shaft"

    def __post_init__(self) -> None:
        check_values(
            self.name, diameter=self.diameter, youngs_modulus=self.youngs_modulus,
            poissons_ratio=self.poissons_ratio, density=self.density, shear_factor=self.shear_factor,
            damping_time=self.damping_time,
        )  # fmt: skip
        if len(self.stations) < 2 or not np.all(np.diff(self.stations) > 0.0):
            raise ModelError(
                f"{self.name}: stations = {list(self.stations)} m: must be two or more, ascending"
            )
        if missing := [z for z in self.discs if z not in self.stations]:
            raise ModelError(
                f"{self.name}: disc at {missing[0]:g} m: no station is there; there are "
                f"{', '.join(f'{z:g}' for z in self.stations)} m"
            )

    def find_segment(self, z: float) -> str:
        """The name of the segment at this station."""
        return f"{self.name} at {1e3 * z:g} mm"

    @cached_property
    def segments(self) -> list[str]:
        return [self.find_segment(z) for z in self.stations]

    def list_bodies(self, speed: float = 0.0, angle: float = 0.0) -> list[Body]:
        """The segments, turning at a speed (rad/s)."""
        z = np.asarray(self.stations, float)
        ends = np.concatenate([z[:1], 0.5 * (z[1:] + z[:-1]), z[-1:]])
        area, second = math.pi * self.diameter**2 / 4.0, math.pi * self.diameter**4 / 64.0
        bodies = []
        for place, length in zip(z, np.diff(ends), strict=True):
            disc = self.discs.get(float(place), Disc(0.0, 0.0, 0.0))
            mass = self.density * area * length
            across = self.density * second * length + mass * length**2 / 12.0 + disc.transverse
            inertia = (across, across, 2.0 * self.density * second * length + disc.polar)
            bodies.append(
                Body(
                    self.find_segment(float(place)), mass + disc.mass, inertia, (0.0, 0.0, float(place)),
                    (0.0, 0.0, angle), angular_velocity=(0.0, 0.0, speed),
                )
            )  # fmt: skip
        return bodies

    def list_beams(self) -> list[ElasticField]:
        """The beams between neighbours."""
        found = []
        for i, length in enumerate(np.diff(self.stations)):
            stiffness = beam_stiffness(
                float(length), self.diameter, self.youngs_modulus, self.poissons_ratio, self.shear_factor
            )
            found.append(
                ElasticField(
                    self.segments[i], self.segments[i + 1], stiffness, self.damping_time * stiffness,
                    (float(length), 0.0, 0.0), axes_i=ALONG_SHAFT, axes_j=ALONG_SHAFT,
                )
            )  # fmt: skip
        return found

    def list_bearings(self) -> list[Joint]:
        """Every segment turns in a bearing, so that the shaft twists but does not bend."""
        return [
            revolute(f"bearing of {name}", GROUND, name, at_i=(0.0, 0.0, float(z)))
            for name, z in zip(self.segments, self.stations, strict=True)
        ]

    def list_pins(self) -> list[Joint]:
        """Both ends may tilt in their bearings; the driven one does not slide."""
        first, last = self.segments[0], self.segments[-1]
        at = (0.0, 0.0, float(self.stations[0]))
        return [
            spherical(f"bearing of {first}", GROUND, first, at_i=at),
            support(f"bearing of {last}", GROUND, last),
        ]

    def drive(self, speed: float, angle: float = 0.0) -> Joint:
        """The first segment turns at a speed (rad/s)."""
        return prescribed_rotation(DRIVE, GROUND, self.segments[0], speed, angle)
