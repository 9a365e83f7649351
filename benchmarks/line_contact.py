"""The transient line contact over the cam's turn: time and memory against nodes and dense factors."""

import math
import time
from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np

from models.contact.asperities import Asperities, pressure_scale
from models.contact.ehl_contact import ContactParameters
from models.contact.fluid import Lubricant
from models.contact.hertz import deflection, elastic_compliance
from models.contact.line.hierarchical import Jacobian, factorise, solve_below
from models.contact.line.mixed import Bodies
from models.contact.line.newton import integrate_pressure
from models.contact.line.reynolds import Flow
from models.contact.line.transient import (
    GAMMA,
    Drives,
    central,
    grid_scale_after,
    place_film,
    step,
    wanted_scale,
)
from models.contact.line.workspace import Workspace, workspace_in, workspace_size
from models.core.quantities import Layout
from models.valve_train.cams.law import law_lift
from models.valve_train.cams.profile import entraining_velocity, radius_of_curvature
from models.valve_train.camshaft import CamshaftParameters
from models.valve_train.valve_spring import ValveSpringParameters

from .measure import measure_medians

NODES = (101, 301, 701, 1501, 3001)
SPEED = 1000.0 * math.pi / 30.0
CAM = Layout(CamshaftParameters).defaults()
SPRING, CONTACT = ValveSpringParameters(), ContactParameters()
LENGTH = 12e-3
BODIES = Bodies(elastic_compliance(207e9, 0.3, 207e9, 0.3), LENGTH)
FLUID = Lubricant(0.036, 1.8e-8)
# No micro-steps: one step for every stretch of the turn, whatever its error.
ANY_ERROR = 1e9


class ContactConditions(NamedTuple):
    """Load (N), entraining velocity (m/s) and radius of curvature (m) on a rigid camshaft."""

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


def build_drives(angle: float, approach: float) -> Drives:
    """The set kushwaha2000 with a massless spring, load given."""
    at = contact_conditions(angle, SPEED, CAM, SPRING)
    return Drives(Flow(at.entraining_velocity, 0.0, at.radius_of_curvature), approach, at.load / LENGTH)


class Turn:
    """The film along the cam, in steps of `degrees`; `roughness` in m."""

    def __init__(self, nodes: int, degrees: float, roughness: float = 0.0) -> None:
        self.degrees = degrees
        rough = Asperities(roughness, CONTACT.roughness_parameter, CONTACT.asperity_slope)
        scale = pressure_scale(rough, BODIES.compliance)
        self.bodies = BODIES._replace(roughness=roughness, asperity_scale=scale)
        self.w: Workspace = workspace_in(np.zeros(workspace_size(nodes)), nodes)
        self.p, self.h, self.slope = np.zeros(nodes), np.zeros(nodes), np.zeros(nodes)

    def run(self, first: float, last: float) -> float:
        """Processor time of the steps between these angles (s), compiled and begun before."""
        angle, film = math.radians(first), 1e-6
        d = build_drives(angle, 0.0)
        load = d.line_load * LENGTH
        approach = deflection(load, d.flow.radius, LENGTH, BODIES.compliance) - film
        scale = wanted_scale(d.line_load, film, d.flow.radius, BODIES)
        place_film(load, film, d.flow.radius, self.bodies, self.w.X, scale, self.p, self.h)
        self.slope[:] = 0.0
        turned = math.radians(self.degrees)
        interval = turned / SPEED
        spent = 0.0
        for _ in range(round((last - first) / self.degrees)):
            drives = [build_drives(angle + share * turned, approach) for share in (0.0, GAMMA, 1.0)]
            begun = time.thread_time()
            load = integrate_pressure(self.p, self.w.weight, scale)
            new_scale = grid_scale_after(
                interval, scale, load, central(self.h), drives[0].flow.radius, self.bodies
            )
            taken = step(
                self.p, self.h, self.slope, scale, new_scale, interval, *drives, ANY_ERROR,
                self.bodies, FLUID, self.w,
            )  # fmt: skip
            spent += time.thread_time() - begun
            if not taken.error <= 1.0:
                raise RuntimeError(f"no step at {math.degrees(angle):g} degrees")
            scale, approach = taken.scale, taken.approach
            angle += turned
        return spent


def time_factors(turn: Turn) -> tuple[float, float]:
    """Processor time of one factorisation and solution (s), by LAPACK and by the hierarchy."""
    w, n = turn.w, turn.p.size
    J = Jacobian(w.A, w.B, w.D, w.weight, 1e-15, 1.0)
    right = np.ones(n)
    full = np.eye(n) + 1e-3 * w.D

    def dense() -> float:
        begun = time.thread_time()
        np.linalg.solve(full, right)
        return time.thread_time() - begun

    def hierarchical() -> float:
        begun = time.thread_time()
        factorise(J, w.fixed, w.hierarchy)
        solve_below(w.hierarchy, 0, w.solution, 1)
        return time.thread_time() - begun

    found = measure_medians({"dense": dense, "hierarchical": hierarchical})
    return found["dense"], found["hierarchical"]


def time_event(nodes: int, last: float) -> tuple[float, float]:
    """Milliseconds of a step of 0.1 degrees from 95 degrees on, and the ratio of dense factors to ours."""
    turn = Turn(nodes, 0.1)
    turn.run(95.0, 96.0)
    spent = turn.run(95.0, last) / ((last - 95.0) / 0.1) * 1e3
    dense, ours = time_factors(turn)
    return spent, dense / ours


def time_turn(nodes: int, roughness: float = 0.0) -> float:
    """Milliseconds of a step of 0.1 degrees over the whole turn."""
    turn = Turn(nodes, 0.1, roughness)
    turn.run(0.0, 1.0)
    return turn.run(0.0, 360.0) / 3600 * 1e3


def measure() -> Iterator[tuple[str, str]]:
    """Figures and their values."""
    for nodes in NODES:
        spent, ratio = time_event(nodes, 225.0 if nodes < 1000 else 115.0)
        memory = workspace_size(nodes) * 8 / 1e6
        yield (
            f"line contact, {nodes} nodes: a step of 0.1 degrees over the cam's event; memory; "
            "dense factors and solution over ours",
            f"{spent:.2f} ms; {memory:.1f} MB; {ratio:.1f}",
        )
        if nodes < 1000:
            yield (
                f"line contact, {nodes} nodes: a step of 0.1 degrees over the whole turn; with 0.2 um of "
                "roughness",
                f"{time_turn(nodes):.2f} ms; {time_turn(nodes, 0.2e-6):.2f} ms",
            )
    turn = Turn(301, 1.0)
    turn.run(0.0, 10.0)
    yield "line contact, 301 nodes: a whole revolution in 360 steps", f"{turn.run(0.0, 360.0):.2f} s"
