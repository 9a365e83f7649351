"""A cam's event with the solved film at 329 angles and 301 nodes: isothermal, and heated over it."""

import math
import time
from functools import partial

import numpy as np

from models.contact.analysis.line.history import film_history
from models.valve_train.cams.law import law_lift
from models.valve_train.cams.profile import entraining_velocity, radius_of_curvature
from models.valve_train.camshaft import camshaft
from models.valve_train.valve_spring import ValveSpringParameters

from .measure import measure_medians

ANGLES, NODES, LAYERS, SPEED = 329, 301, 8, 1000.0 * math.pi / 30.0
EYRING = 5e6


def drive_cam() -> tuple[np.ndarray, ...]:
    """Times, load, entraining velocity, radius and sliding of the default cam under a massless spring."""
    cam, spring = camshaft().parameters.defaults(), ValveSpringParameters()
    angles = np.radians(np.linspace(95.0, 225.0, ANGLES + 1))
    found = []
    for lift in (law_lift(angle, cam) for angle in angles):
        load = spring.preload + spring.spring_rate * lift.s + spring.valve_mass * lift.dds * SPEED**2
        velocity, radius = (
            entraining_velocity(cam.base_radius, lift, SPEED),
            radius_of_curvature(cam.base_radius, lift),
        )
        found.append((load, velocity, radius, (cam.base_radius + lift.s) * SPEED))
    return angles / SPEED, *np.array(found).T


def solve(layers: int, eyring_stress: float = 0.0) -> float:
    """Processor time (s) of the event."""
    *motion, sliding = drive_cam()
    began = time.process_time()
    eyring = {"eyring_stress": eyring_stress}
    film_history(*motion, NODES, eyring, sliding_velocity=sliding, layers=layers)
    return time.process_time() - began


def measure() -> list[tuple[str, str]]:
    """Figures and their values."""
    found = measure_medians(
        {
            "isothermal": partial(solve, 0),
            "heated": partial(solve, LAYERS),
            "heated, Eyring stress of 5 MPa": partial(solve, LAYERS, EYRING),
        },
        rounds=3,
    )
    cold = found.pop("isothermal")
    rows = [(f"film of a cam at {ANGLES} angles, {NODES} nodes: isothermal", f"{cold:.2f} s")]
    return rows + [
        (f"film of a cam at {ANGLES} angles: {name}", f"{one:.2f} s ({one / cold:.1f} x)")
        for name, one in found.items()
    ]
