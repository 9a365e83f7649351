"""The set kushwaha2000 on a rigid camshaft with a massless spring: what its contact sees."""

import math
from typing import NamedTuple

import numpy as np

from models.contact.analysis.line.history import FilmHistory, film_history
from models.contact.fluid import Lubricant
from models.contact.hertz import elastic_compliance
from models.contact.line.mixed import Bodies
from models.core.quantities import Vector
from models.valve_train.cams.law import law_lift
from models.valve_train.cams.profile import entraining_velocity, radius_of_curvature
from models.valve_train.camshaft import camshaft
from models.valve_train.valve_spring import ValveSpringParameters

LENGTH = 12e-3
BODIES = Bodies(elastic_compliance(207e9, 0.3, 207e9, 0.3), LENGTH)
FLUID = Lubricant(0.036, 1.8e-8)


class Conditions(NamedTuple):
    load: float
    velocity: float
    radius: float


def conditions(angle: float, speed: float) -> Conditions:
    """At a cam angle (rad, nose at pi) and speed (rad/s): W = f_p + k0 s + m3 s'' omega^2."""
    cam, spring = camshaft().parameters.defaults(), ValveSpringParameters()
    lift = law_lift(angle, cam)
    return Conditions(
        spring.preload + spring.spring_rate * lift.s + spring.valve_mass * lift.dds * speed**2,
        entraining_velocity(cam.base_radius, lift, speed),
        radius_of_curvature(cam.base_radius, lift),
    )


class Motion(NamedTuple):
    times: Vector
    load: Vector
    velocity: Vector
    radius: Vector


def motion(degrees: Vector, revolutions_per_minute: float) -> Motion:
    """Load, entraining velocity and radius at these cam angles (nose at 180)."""
    speed = revolutions_per_minute * math.pi / 30.0
    found = np.array([conditions(a, speed) for a in np.radians(degrees)])
    return Motion(np.radians(degrees) / speed, *found.T)


def cycle(step: float, nodes: int, speed: float = 1000.0) -> tuple[Vector, FilmHistory]:
    """Cam angles (degrees) over the event and the film at them; speed in r/min."""
    degrees = np.linspace(95.0, 225.0, round(130.0 / step) + 1)
    m = motion(degrees, speed)
    return degrees[1:], film_history(m.times, m.load, m.velocity, m.radius, nodes)
