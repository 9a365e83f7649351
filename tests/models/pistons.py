"""Runs of the tilting piston that tests share."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from models.core.component import Component
from models.core.integrator import OK
from models.core.quantities import Vector
from models.slider_crank.piston.free_piston_crank import free_piston_crank
from models.slider_crank.piston.piston_crank import piston_crank

DRIVEN, FREE = piston_crank(), free_piston_crank()
# F section 4.1 with M = l = 1; the roller has a moment of inertia, which nothing turns.
ROLLER: Mapping[str, float] = {
    "crank_radius": 0.3030,
    "rod_length": 1.0,
    "rod_mass": 1.9,
    "rod_centre": 0.5,
    "rod_inertia": 0.4719,
    "piston_mass": 1.0,
    "piston_inertia": 1.0,
    "half_length": 0.0,
    "half_height": 0.0,
    "pin_height": 0.0,
    "mass_height": 0.0,
    "piston_pin_friction": 0.0,
    "wall_friction": 0.0,
}


def advance(
    component: Component, x: Vector, p: Vector, t: float, h: float, **inputs: tuple[float, ...] | float
) -> dict[str, float]:
    """Advance x in place; inputs by name, as a value or as value and derivatives. Outputs by name."""
    U = component.input_polynomial()
    for name, value in inputs.items():
        given = np.atleast_1d(value)
        U[: given.size, component.inputs.index(name)] = given
    y, u = np.zeros(component.outputs.size), np.zeros(component.inputs.size)
    work = np.zeros(component.work_size)
    assert component.step(t, h, x, U, p, component.state.nominal, work, u, y) == OK
    return component.outputs.named(y)


def turn(x: Vector, p: Vector, start: float, angle: float, speed: float = 1.0) -> dict[str, float]:
    """Advance the driven mechanism by `angle` at constant speed from crank angle `start`."""
    crank = {"crank_angle": (start, speed), "crank_speed": speed}
    return advance(DRIVEN, x, p, start / speed, angle / speed, **crank)
