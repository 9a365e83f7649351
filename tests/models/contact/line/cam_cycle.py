"""The set kushwaha2000 on a rigid camshaft with a massless spring: what its contact sees."""

import math
from typing import NamedTuple

import numpy as np

from benchmarks.line_contact import Turn, contact_conditions
from models.contact.analysis.line.history import FilmHistory, film_history
from models.contact.line.grid import REACH, fill_kernel_matrix, place_nodes
from models.core.quantities import Layout, Vector
from models.valve_train.camshaft import CamshaftParameters
from models.valve_train.valve_spring import ValveSpringParameters


class Motion(NamedTuple):
    times: Vector
    load: Vector
    velocity: Vector
    radius: Vector


def motion(degrees: Vector, revolutions_per_minute: float) -> Motion:
    """Load, entraining velocity and radius at these cam angles (nose at 180)."""
    speed = revolutions_per_minute * math.pi / 30.0
    cam, spring = Layout(CamshaftParameters).defaults(), ValveSpringParameters()
    conditions = np.array([contact_conditions(a, speed, cam, spring) for a in np.radians(degrees)])
    return Motion(np.radians(degrees) / speed, *conditions.T)


def cycle(step: float, nodes: int, speed: float = 1000.0) -> tuple[Vector, FilmHistory]:
    """Cam angles (degrees) over the event and the film at them; speed in r/min."""
    degrees = np.linspace(95.0, 225.0, round(130.0 / step) + 1)
    m = motion(degrees, speed)
    return degrees[1:], film_history(m.times, m.load, m.velocity, m.radius, nodes)


def least_films(degrees: Vector, nodes: int, reach: float = REACH) -> Vector:
    """Smallest films (m) at these cam angles, with a grid that reaches so many of its scales."""
    turn = Turn(nodes, 0.1)
    place_nodes(turn.w.X, reach)
    fill_kernel_matrix(turn.w.X, turn.w.weight, turn.w.D)
    found = []
    for angle in degrees:
        turn.run(95.0, angle)
        found.append(turn.h.min())
    return np.array(found)
