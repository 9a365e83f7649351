"""What a component is in a mechanism: roles, by which figures, drawings, tables and advice find it.

A role promises variables and parameters of the component; a field of a role names one whose name is the
component's own. `Component` checks the outputs that its roles promise.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, fields
from typing import ClassVar, TypeVar


@dataclass(frozen=True)
class Role:
    """A role; `outputs` are those that every component in it has. Fields of a role name further outputs."""

    outputs: ClassVar[Sequence[str]] = ()

    @property
    def promised(self) -> list[str]:
        """All outputs that a component in this role must have."""
        return [*self.outputs, *(getattr(self, field.name) for field in fields(self))]


SomeRole = TypeVar("SomeRole", bound=Role)


@dataclass(frozen=True)
class Drive(Role):
    """Turns shafts. Parameters: `motion`, and with a prescribed one `initial_speed` and `final_speed`."""

    outputs = ("angle", "supplied_torque")


@dataclass(frozen=True)
class Cam(Role):
    """Has a cam, at the profile's `angle` (rad), with this radius of curvature (m) where it touches, and
    this torque of its shaft on it (N m)."""

    outputs = ("cam_lift",)

    angle: str = "profile_angle"
    radius_of_curvature: str = "cam_radius"
    torque: str = "cam_torque"


class TwistedCam(Role):
    """A cam on an elastic shaft. Parameters: `drive_ratio`, `phase`."""

    outputs = ("cam_angle",)


class FlatFollower(Role):
    """Its cam moves a flat follower that belongs to the valve. Parameter: `base_radius`."""

    outputs = ("cam_angle", "entraining_velocity")


class TranslatingFollower(Role):
    """Moves along its guide. Parameters: `follower`, `base_radius`, `follower_radius`, `offset`."""

    outputs = ("position", "velocity", "acceleration", "profile_angle", "entraining_velocity")


class PivotedFollower(Role):
    """Turns about its end. Parameters: those of `finger`."""

    outputs = ("rotation", "profile_angle", "entraining_velocity", "tip_entraining_velocity")


class Rod(Role):
    """A pushrod between tappet and rocker."""


@dataclass(frozen=True)
class Rocker(Role):
    """Turns about its middle and opens a valve. Parameters: those of `rocker`. By `find_rod_position` of the
    position of the valve's end (m) and the parameters its rod's end has moved so far (m)."""

    outputs = ("rotation", "rod_position", "tip_position")

    find_rod_position: Callable[[float, Mapping[str, float]], float]

    @property
    def promised(self) -> list[str]:
        return list(self.outputs)


class Losing(Role):
    """Loses power by its output `friction`, which the parts that it brakes take."""

    friction: ClassVar[str] = "friction_force"

    @property
    def promised(self) -> list[str]:
        return [*super().promised, self.friction]


class Contact(Losing):
    """A lubricated contact. Parameters: `length`, `roughness`, `elastic_limit` and the oil's."""

    outputs = (
        "load", "maximum_pressure", "film_thickness", "minimum_film_thickness", "film_ratio",
        "squeeze_velocity", "asperity_load",
    )  # fmt: skip


class RollingContact(Losing):
    """A contact with a rolling friction of both its surfaces. Input: `entraining_velocity`."""

    friction = "rolling_friction"


class Valve(Role):
    """Opens and lands. Parameter: `seat_stiffness`."""

    outputs = ("valve_lift", "position", "velocity", "acceleration", "seat_dip", "seat_force")


class CoilSpring(Role):
    """A spring apart from the valve. Input: `position`, zero with the valve closed. Parameters: the
    `preload` there, and the gaps of its coils."""

    outputs = ("force", "least_gap", "clash_force")


class LoadedSpring(Role):
    """A spring in one part with the valve that it closes. Parameters: `preload` of the closed valve,
    `spring_rate`."""

    outputs = ("least_gap", "valve_lift", "spring_force")


class Adjuster(Role):
    """A hydraulic lash adjuster, with an oil, which flows out by a leak and in through a check valve.
    Parameter: `plunger_diameter`. Inputs: `lower_position`, `upper_position` of the bodies that it parts."""

    outputs = ("force", "pressure", "extension", "leak_flow", "valve_flow")


class Bearing(Losing):
    """A bearing with a film, and an oil. Films are known up to the eccentricity `near` (of the clearance).

    Under a steady load, grooves nearer to it than `load_zone` (rad) leave 0.05 to 1 times the film that they
    leave at a right angle to it (L/D 0.25 to 1, eccentricities 0.3 to 0.93, grooves of 20 degrees).
    """

    friction = "friction_torque"

    near: ClassVar[float] = 0.95
    load_zone: ClassVar[float] = math.radians(40.0)

    outputs = (
        "load", "minimum_film_thickness", "film_ratio", "eccentricity_ratio", "maximum_pressure",
        "power_loss",
    )  # fmt: skip


class Pivot(Losing):
    """A joint with friction."""

    friction = "friction_torque"

    outputs = ("power_loss",)


class Guide(Losing):
    """A guide with friction along it, or a follower's spin in it."""

    outputs: ClassVar[Sequence[str]] = ("power_loss",)


class Spin(Guide):
    """A tappet's spin in its bore, between cam and contact. Input: `sliding_velocity` without spin."""

    friction = "cam_friction"
    outputs = ("contact_sliding", "power_loss")


class Oiled(Role):
    """Has the `viscosity` of an oil among its parameters, and is no contact, bearing or adjuster."""


class Surface(Losing):
    """Its friction takes the place of that of the contact whose `load` it takes."""

    outputs: ClassVar[Sequence[str]] = ("power_loss",)


class Roller(Surface):
    """A follower's roller, which may slip."""

    friction = "traction"
    outputs = ("slip", "power_loss")


class Crank(Role):
    """A slider-crank whose slider has a clearance."""


class PistonCrank(Role):
    """A slider-crank whose piston tilts in its liner."""


class DrawnShaft(Role):
    """A shaft whose modes come from a drawing."""


class CylinderGas(Role):
    """A gas whose pressure a cycle of points gives."""


class PistonClearance(Role):
    """Watches a valve and the piston. Input: `angle`. Parameters: `pocket_depth`, `angle_ratio`,
    `top_angle`."""

    outputs = ("clearance", "radial_clearance")
