"""The set kushwaha2000 on a rigid camshaft with a massless spring: what its contact sees."""

import math
from typing import NamedTuple

import numpy as np

from models.contact.analysis.line.history import FilmHistory, film_history
from models.contact.fluid import Lubricant
from models.contact.friction import Traction
from models.contact.hertz import deflection, elastic_compliance
from models.contact.line.grid import REACH, fill_kernel_matrix, place_nodes
from models.contact.line.mixed import Bodies
from models.contact.line.newton import integrate_pressure
from models.contact.line.reynolds import Flow
from models.contact.line.shear import no_heat
from models.contact.line.transient import (
    GAMMA,
    Drives,
    central,
    grid_scale_after,
    place_film,
    step,
    wanted_scale,
)
from models.contact.line.workspace import workspace_in, workspace_size
from models.core.quantities import Layout, Vector
from models.valve_train.cams.law import law_lift
from models.valve_train.cams.profile import entraining_velocity, radius_of_curvature
from models.valve_train.camshaft import CamshaftParameters
from models.valve_train.valve_spring import ValveSpringParameters

LENGTH = 12e-3
BODIES = Bodies(elastic_compliance(207e9, 0.3, 207e9, 0.3), LENGTH)
FLUID, COLD = Lubricant(0.036, 1.8e-8), no_heat(Traction())
# No micro-steps: one step for every tenth of a degree, whatever its error.
TENTH, ANY_ERROR = math.radians(0.1), 1e9


class Conditions(NamedTuple):
    load: float
    velocity: float
    radius: float


def conditions(angle: float, speed: float) -> Conditions:
    """At a cam angle (rad, nose at pi) and speed (rad/s): W = f_p + k0 s + m3 s'' omega^2."""
    cam, spring = Layout(CamshaftParameters).defaults(), ValveSpringParameters()
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


def least_films(degrees: Vector, nodes: int, reach: float = REACH) -> Vector:
    """Smallest films (m) at these cam angles, 1000 r/min, with a grid that reaches so many of its scales."""
    w = workspace_in(np.zeros(workspace_size(nodes)), nodes)
    place_nodes(w.X, reach)
    fill_kernel_matrix(w.X, w.weight, w.D)
    speed, p, h, slope = 1000.0 * math.pi / 30.0, np.zeros(nodes), np.zeros(nodes), np.zeros(nodes)

    def drive(angle: float, approach: float) -> Drives:
        at = conditions(angle, speed)
        return Drives(Flow(at.velocity, 0.0, at.radius), approach, at.load / LENGTH)

    def find(last: float) -> float:
        angle, film = math.radians(95.0), 1e-6
        d = drive(angle, 0.0)
        load = d.line_load * LENGTH
        approach = deflection(load, d.flow.radius, LENGTH, BODIES.compliance) - film
        scale = wanted_scale(d.line_load, film, d.flow.radius, BODIES)
        place_film(load, film, d.flow.radius, BODIES, w.X, scale, p, h)
        slope[:] = 0.0
        for _ in range(round((last - 95.0) / 0.1)):
            drives = [drive(angle + share * TENTH, approach) for share in (0.0, GAMMA, 1.0)]
            load = integrate_pressure(p, w.weight, scale)
            wanted = grid_scale_after(TENTH / speed, scale, load, central(h), drives[0].flow.radius, BODIES)
            taken = step(
                p, h, slope, scale, wanted, TENTH / speed, *drives, ANY_ERROR, BODIES, FLUID, COLD, w
            )
            assert taken.error <= 1.0, f"no step at {math.degrees(angle):g} degrees"
            scale, approach = taken.scale, taken.approach
            angle += TENTH
        return float(h.min())

    return np.array([find(angle) for angle in degrees])
