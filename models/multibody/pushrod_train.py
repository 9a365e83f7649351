"""The single valve train of Qin and Zuo 2000 (Q): cam, tappet, pushrod, rocker, valve and spring.

Axes: z along the shaft, y along tappet and pushrod; the valve opens towards -y. Q section 1.2 has revolute,
translational and fixed joints and contacts of curves. The pushrod is rigid, or stands in finite segments,
Q (1).
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

from ..valve_train.cams.law import LAW
from ..valve_train.cams.profile import CamProfile
from .bodies import GROUND, Body, Point, check_values
from .coils import Coils, hang_coils
from .fill import Force
from .forces import ContactSpring, LubricatedCam, SpringDamper, rod_rate
from .joints import (
    Joint,
    LeverEnd,
    flat_cam,
    lever_end,
    plane_contact,
    prescribed_rotation,
    revolute,
    translational,
)
from .mechanism import Mechanism

BEARING, DRIVE, PIVOT = "bearing", "drive", "rocker's pivot"
CAM, SEAT, ROD_END, TIP = "cam and tappet", "tappet and pushrod", "pushrod and rocker", "rocker and valve"
VALVE_SEAT = "valve's seat"
DOWN: Point = (0.0, -1.0, 0.0)
BACK: Point = (0.0, 0.0, -1.0)
# Moments of inertia (kg m^2) of parts that only slide: they have no effect.
SLIDING_INERTIA = (1e-5, 1e-5, 1e-5)
# Of a rocker with its centre of mass on its pivot, and of a cam at constant speed; neither has an effect.
ROCKER_MASS = 0.2
CAM_MASS, CAM_INERTIA = 0.2, (1e-4, 1e-4, 1.2e-4)


# What the components of the lubricated contacts are called.
OILS = {CAM: "cam_contact", TIP: "valve_contact"}


@dataclass(frozen=True)
class PushrodTrain:
    """The train from parameters and states of `tappet`, `pushrod`, `rocker` and `valve_spring`.

    The pushrod has so many segments; with 0 it is rigid. Contacts that have the parameters of an
    `ehl_contact`, see OILS, have an oil film; without, the surfaces stay together.
    """

    parts: Mapping[str, Any]
    states: Mapping[str, Any]
    segments: int = 4
    coil_masses: int = 2

    def __post_init__(self) -> None:
        rod = self.parts["pushrod"]
        check_values("pushrod", density=rod.density, damping_time=rod.damping_time)

    @cached_property
    def heights(self) -> tuple[float, float, float]:
        """Of the tappet, of the rocker's pivot and of the valve (m), without lash, with the valve closed."""
        r, rod, tappet = self.parts["rocker"], self.parts["pushrod"], float(self.parts["tappet"].base_radius)
        # At the angle 0 the ends are tip_radius -+ arm sin(angle) below the pivot.
        pivot = tappet + rod.length + rod.clearance + r.tip_radius + r.rod_arm * math.sin(r.rod_angle)
        return tappet, pivot, pivot - r.tip_radius + r.valve_arm * math.sin(r.valve_angle)

    @cached_property
    def columns(self) -> tuple[float, float]:
        """x of the rocker's pivot and of the valve; the pushrod is at 0 (m)."""
        r = self.parts["rocker"]
        pivot = float(r.rod_arm * math.cos(r.rod_angle))
        return pivot, pivot + float(r.valve_arm * math.cos(r.valve_angle))

    @property
    def closed(self) -> Point:
        """Where the valve sits on its seat (m)."""
        return self.columns[1], self.heights[2] - float(self.parts["valve_spring"].lash), 0.0

    @cached_property
    def rods(self) -> list[str]:
        """Names of the pushrod's segments, from the tappet on."""
        return [f"pushrod segment {i + 1}" for i in range(self.segments)] or ["pushrod"]

    @cached_property
    def coils(self) -> Coils:
        names = [f"spring mass {i + 1}" for i in range(self.coil_masses)]
        spring, moved = self.parts["valve_spring"], self.states["valve_spring"].coil_position
        return hang_coils(spring, "valve", names, self.closed, DOWN, moved)

    @property
    def _length(self) -> float:
        """Of a segment (m)."""
        return float(self.parts["pushrod"].length) / len(self.rods)

    def build(self, speed: float, profile: CamProfile = LAW) -> Mechanism:
        """The train on a cam of its own at a constant speed (rad/s)."""
        angle = float(self.states["flywheel"].angle)
        turned, turning = (0.0, 0.0, angle), (0.0, 0.0, speed)
        cam = Body("cam", CAM_MASS, CAM_INERTIA, angles=turned, angular_velocity=turning)
        drive = [revolute(BEARING, GROUND, "cam"), prescribed_rotation(DRIVE, GROUND, "cam", speed, angle)]
        bodies, joints = [cam, *self._list_bodies()], [*drive, *self._list_joints()]
        return Mechanism(bodies, joints, self._list_forces(), profile=profile)

    def _list_bodies(self) -> list[Body]:
        """Tappet, pushrod, rocker, valve and masses of the spring."""
        tappet, pivot, valve = self.heights
        rod, length, turning = self.parts["pushrod"], self._length, float(self.parts["rocker"].inertia)
        lifted, opening = float(self.states["tappet"].position), float(self.states["valve_spring"].position)
        mass = float(rod.density * rod.area) * length
        across = mass * length**2 / 12.0
        inertia = across, mass * float(rod.area) / (2.0 * math.pi), across
        moved = [float(x) for x in self.states["pushrod"].displacement]
        return [
            Body(
                "tappet", float(self.parts["tappet"].mass), SLIDING_INERTIA, (0.0, tappet + lifted, 0.0)
            ),
            *(
                Body(name, mass, inertia, (0.0, tappet + (i + 0.5) * length + moved[i], 0.0))
                for i, name in enumerate(self.rods)
            ),
            Body(
                "rocker", ROCKER_MASS, (turning, turning, turning),
                (self.columns[0], pivot, 0.0), (0.0, 0.0, -float(self.states["rocker"].rotation)),
            ),
            Body(
                "valve", float(self.parts["valve_spring"].valve_mass), SLIDING_INERTIA,
                (self.columns[1], valve - opening, 0.0),
            ),
            *self.coils.bodies,
        ]  # fmt: skip

    def _list_joints(self) -> list[Joint]:
        """Guides, pivot, and the contacts that are held."""
        held = [self._touch(name) for name, part in OILS.items() if part not in self.parts]
        held += [] if self.segments else [self._touch(SEAT), self._touch(ROD_END)]
        return [
            *held,
            *(translational(f"guide of {name}", GROUND, name) for name in ("tappet", *self.rods)),
            revolute(PIVOT, GROUND, "rocker", at_i=(self.columns[0], self.heights[1], 0.0)),
            translational("guide of valve", GROUND, "valve", at_i=(self.columns[1], 0.0, 0.0)),
            *self.coils.guides,
        ]

    def _list_forces(self) -> list[Force]:
        """Oil films, the pushrod's springs, seat and spring of the valve."""
        rod, valve = self.parts["pushrod"], self.parts["valve_spring"]
        found: list[Force] = [
            LubricatedCam(self._touch(name), self.parts[part], float(self.states[part].film_thickness))
            for name, part in OILS.items()
            if part in self.parts
        ]
        if self.segments:
            inner = rod_rate(rod.youngs_modulus, rod.area, self._length)
            damping, bonded = float(rod.damping_time) * inner, bool(rod.bonded)
            # Q (1): 2 A E/L at both ends of each segment, so A E/L between two centres.
            found += [
                ContactSpring(self._touch(name), 2.0 * inner, 2.0 * damping, bonded)
                for name in (SEAT, ROD_END)
            ]
            found += [
                SpringDamper(lower, upper, inner, self._length, damping)
                for lower, upper in zip(self.rods, self.rods[1:], strict=False)
            ]
        if valve.seat_stiffness > 0.0:
            found.append(ContactSpring(self._touch(VALVE_SEAT), valve.seat_stiffness, valve.seat_damping))
        return [*found, *self.coils.springs]

    def _touch(self, name: str) -> Joint:
        """The contact of that name."""
        half, r, tappet = 0.5 * self._length, self.parts["rocker"], self.parts["tappet"]
        if name == CAM:
            foot = (-math.sin(tappet.phase), math.cos(tappet.phase), 0.0)
            return flat_cam(name, "cam", "tappet", tappet, foot=foot)
        if name == SEAT:
            return plane_contact(name, "tappet", self.rods[0], at_j=(0.0, -half, 0.0))
        if name == VALVE_SEAT:
            return plane_contact(name, GROUND, "valve", normal=DOWN, at_i=self.closed)
        radius, constant = float(r.tip_radius), bool(r.small_motion)
        if name == ROD_END:
            # The arm rises, and the lever turns against the axis Z, as the pushrod lifts it.
            end = LeverEnd(float(r.rod_arm), -float(r.rod_angle), radius, constant)
            return lever_end(name, "rocker", self.rods[-1], end, at_slider=(0.0, half, 0.0), normal=DOWN)
        end = LeverEnd(float(r.valve_arm), float(r.valve_angle), radius, constant)
        return lever_end(name, "rocker", "valve", end, axis=BACK, normal=DOWN)
