"""The set kushwaha2000 on a rigid camshaft with a massless spring: what its contact sees."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from models.contact.line.history import FilmHistory, film_history
from models.quantities import Vector
from models.valve_train import cam_profile
from models.valve_train.camshaft import CamshaftParameters

SPRING_RATE, PRELOAD, MASS = 35e3, 330.0, 0.22


class Motion(NamedTuple):
    times: Vector
    load: Vector
    velocity: Vector
    radius: Vector


def motion(degrees: Vector, revolutions_per_minute: float) -> Motion:
    """Load, entraining velocity and radius at these cam angles (nose at 180)."""
    p = CamshaftParameters()
    speed = revolutions_per_minute * math.pi / 30.0
    lifts = [
        cam_profile.cycloidal_lift(math.radians(a), p.lift, p.rise_angle, p.dwell_half_width) for a in degrees
    ]
    return Motion(
        np.radians(degrees) / speed,
        np.array([PRELOAD + SPRING_RATE * c.s + MASS * c.dds * speed**2 for c in lifts]),
        np.array([cam_profile.entraining_velocity(p.base_radius, c, speed) for c in lifts]),
        np.array([cam_profile.radius_of_curvature(p.base_radius, c) for c in lifts]),
    )


def cycle(step: float, nodes: int, speed: float = 1000.0) -> tuple[Vector, FilmHistory]:
    """Cam angles (degrees) over the event and the film at them; speed in r/min."""
    degrees = np.linspace(95.0, 225.0, round(130.0 / step) + 1)
    m = motion(degrees, speed)
    return degrees[1:], film_history(m.times, m.load, m.velocity, m.radius, nodes)
