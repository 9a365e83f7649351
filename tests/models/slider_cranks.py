"""Slider-cranks that tests share: F's engine with M = l = 1, the tilting piston, and steps of both."""

import math
from collections.abc import Mapping

import numpy as np

from models.core.component import Component
from models.core.integrator import OK
from models.core.quantities import Vector
from models.slider_crank import forms
from models.slider_crank.piston.piston_crank import free_piston_crank, piston_crank
from models.slider_crank.records import WALL_FILMS
from models.slider_crank.slider_crank import slider_crank

# Flores, Leine and Glocker (2010), table 1; the gravity acts across the cylinder.
FLORES: Mapping[str, float] = {
    "crank_radius": 0.153,
    "rod_length": 0.306,
    "crank_mass": 0.038,
    "crank_centre": 0.5 * 0.153,
    "crank_inertia": 7.4e-5,
    "rod_mass": 0.038,
    "rod_centre": 0.5 * 0.306,
    "rod_inertia": 5.9e-4,
    "piston_mass": 0.076,
    "piston_inertia": 2.7e-6,
    "half_length": 0.05,
    "half_height": 0.025,
    "clearance": 0.001,
    "pin_height": 0.0,
    "pin_offset": 0.0,
    "mass_height": 0.0,
    "mass_offset": 0.0,
    "crank_pin_friction": 0.0,
    "piston_pin_friction": 0.0,
    "wall_friction": 0.01,
    "restitution": 0.4,
    "gravity_across": -9.81,
}

CRANK, DRIVEN, FREE = slider_crank(), piston_crank(), free_piston_crank()
STATE, INPUTS, OUTPUTS = CRANK.state, CRANK.inputs, CRANK.outputs
FORMS = (forms.AS_PUBLISHED, forms.CORRECTED, forms.NONLINEAR)
TURN = 2.0 * math.pi
# Sizes at unit speed: rates of psi are of the size of psi.
SCALE = STATE.nominal.copy()
SCALE[STATE.index("psi_rate")] = 1e-2
FILMS = [STATE.index(name) for name in WALL_FILMS]
# Film lag at unit speed (rad): 20 us at 100 rad/s.
LAG = 2e-3
# F section 4.1. As a piston the roller has a moment of inertia, which nothing turns.
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


def thesis_parameters(damping: float, gap: float, **values: float) -> Vector:
    """F's dimensionless engine as a component: speed 1 gives F's lambda and rho."""
    unit = {name: value for name, value in ROLLER.items() if name in CRANK.parameters.names}
    return CRANK.parameters.vector(
        {**unit, "form": 0.0, "joint_friction": damping, "clearance": gap, "film_lag": LAG, **values}
    )


def advance(
    component: Component, x: Vector, p: Vector, t: float, h: float, **inputs: tuple[float, ...] | float
) -> dict[str, float]:
    """Advance x in place; inputs by name, as a value or as value and derivatives. Outputs by name."""
    U = component.input_polynomial()
    for name, value in inputs.items():
        given = np.atleast_1d(value)
        U[: given.size, component.inputs.index(name)] = given
    y, u = np.zeros(component.outputs.size), np.zeros(component.inputs.size)
    scale = SCALE if component is CRANK else component.state.nominal
    assert component.step(t, h, x, U, p, scale, np.zeros(component.work_size), u, y) == OK
    return component.outputs.named(y)


def turn(
    component: Component, x: Vector, p: Vector, start: float, angle: float, speed: float = 1.0,
    **inputs: float,
) -> dict[str, float]:  # fmt: skip
    """Advance by `angle` at constant speed from crank angle `start`, where the time is start / speed."""
    crank = {"crank_angle": (start, speed), "crank_speed": speed}
    return advance(component, x, p, start / speed, angle / speed, **crank, **inputs)


def energies(component: Component, x: Vector, u: Vector, p: Vector) -> Vector:
    """Stored energy (J), dissipated and given power (W)."""
    e = np.zeros(3)
    component.flat_energy(0.0, x, u, p, e)
    return e


def power_imbalance(component: Component, x: Vector, U: Vector, p: Vector) -> tuple[float, float]:
    """d(stored)/dt - (torque * speed - dissipated + given), and the size of these powers.

    The difference quotient has an error (speed d)^4 at up to 300 rad/s, and rounding / d.
    """
    dx, y = np.zeros(component.state.size), np.zeros(component.outputs.size)
    component.flat_derivative(0.0, x, U[0], p, dx)
    component.flat_output(0.0, x, U[0], p, y)
    taken = y[component.outputs.index("crank_torque")] * U[0, component.inputs.index("crank_speed")]
    _, lost, given = energies(component, x, U[0], p)

    def stored(s: float) -> float:
        return float(energies(component, x + s * dx, U[0] + s * U[1] + 0.5 * s**2 * U[2], p)[0])

    d = 1e-3 / 300.0
    change = (8.0 * (stored(d) - stored(-d)) - (stored(2.0 * d) - stored(-2.0 * d))) / (12.0 * d)
    return change - (taken - lost + given), abs(taken) + abs(lost) + abs(given)
