"""What the contact sees on a rigid camshaft of steady speed, with a massless spring."""

from typing import Any, NamedTuple

from .cams.law import law_lift
from .cams.profile import entraining_velocity, radius_of_curvature
from .valve_spring import ValveSpringParameters


class ContactConditions(NamedTuple):
    """Load (N), entraining velocity (m/s) and radius of curvature (m)."""

    load: float
    entraining_velocity: float
    radius_of_curvature: float


def contact_conditions(
    angle: float, speed: float, cam: Any, spring: ValveSpringParameters
) -> ContactConditions:
    """At a cam angle (rad, nose at pi) and speed (rad/s): W = f_p + k0 s + m3 s'' omega^2.

    `cam` is a record of parameters of a cam by a law.
    """
    lift = law_lift(angle, cam)
    return ContactConditions(
        spring.preload + spring.spring_rate * lift.s + spring.valve_mass * lift.dds * speed**2,
        entraining_velocity(cam.base_radius, lift, speed),
        radius_of_curvature(cam.base_radius, lift),
    )
