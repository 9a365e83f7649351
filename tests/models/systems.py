"""Systems that tests share."""

import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from models.catalogue import CATALOGUE
from models.core.component import Component
from models.core.quantities import Vector
from models.core.system import Instance, System
from models.monolithic.cvode import Cvode
from models.monolithic.march import march
from models.monolithic.reference import observe, stiffness

VALVE_TRAIN = (
    ("flywheel.angle", "camshaft.drive_angle"),
    ("flywheel.speed", "camshaft.drive_speed"),
    ("flywheel.acceleration", "camshaft.drive_acceleration"),
    ("camshaft.drive_torque", "flywheel.load_torque[1]"),
    ("camshaft.surface_position", "contact.approach"),
    ("camshaft.surface_velocity", "contact.approach_rate"),
    ("valve_spring.position", "contact.retreat"),
    ("valve_spring.velocity", "contact.retreat_rate"),
    ("camshaft.entraining_velocity", "contact.entraining_velocity"),
    ("camshaft.sliding_velocity", "contact.sliding_velocity"),
    ("camshaft.radius_of_curvature", "contact.radius_of_curvature"),
    ("contact.load", "camshaft.contact_load"),
    ("contact.load", "valve_spring.load"),
)
DRY = {"film_model": 7.0}


def wheel(speed: float, angle: float = 0.0, **more: float) -> Instance:
    """A flywheel that turns at a constant speed (rad/s)."""
    parameters = {"initial_speed": speed, "final_speed": speed, **more}
    return Instance(CATALOGUE["flywheel"](), parameters, start={"angle": angle, "speed": speed})


def valve_train(
    speed_rpm: float = 1000.0,
    *,
    flywheel: Mapping[str, float] | None = None,
    camshaft: Mapping[str, float] | None = None,
    valve_spring: Mapping[str, float] | None = None,
    contact: Mapping[str, float] | None = None,
    coil_masses: int = 2,
) -> System:
    """The valve train of the set `kushwaha2000` at a constant cam speed, with changed parameters."""
    return System(
        {
            "flywheel": wheel(speed_rpm * math.pi / 30.0, **(flywheel or {})),
            "camshaft": Instance(CATALOGUE["camshaft"](), camshaft or {}),
            "valve_spring": Instance(CATALOGUE["valve_spring"](coil_masses=coil_masses), valve_spring or {}),
            "contact": Instance(CATALOGUE["ehl_contact"](), contact or {}),
        },
        VALVE_TRAIN,
    )


def turn(speed_rpm: float) -> float:
    """Duration of one turn of the cam (s)."""
    return 60.0 / speed_rpm


def column(system: System, outputs: Vector, name: str) -> Vector:
    """The output called "instance.variable" of a table of outputs."""
    return outputs[:, system.outputs.names.index(name)]


Values = Mapping[str, float] | None


def outputs_of(
    component: Component,
    parameters: Values = None,
    state: Values = None,
    inputs: Values = None,
    t: float = 0.0,
) -> dict[str, float]:
    """A component's outputs by name."""
    y = component.outputs.start.copy()
    component.flat_output(t, *_vectors(component, parameters, state, inputs), y)
    return component.outputs.named(y)


def rates_of(
    component: Component,
    parameters: Values = None,
    state: Values = None,
    inputs: Values = None,
    t: float = 0.0,
) -> dict[str, float]:
    """A component's state derivatives by name."""
    dx = np.zeros(component.state.size)
    component.flat_derivative(t, *_vectors(component, parameters, state, inputs), dx)
    return component.state.named(dx)


def _vectors(component: Component, parameters: Values, state: Values, inputs: Values) -> list[Vector]:
    pairs = ((component.state, state), (component.inputs, inputs), (component.parameters, parameters))
    return [layout.vector(values) for layout, values in pairs]


def state_matrix(
    component: Component,
    parameters: Values = None,
    inputs: Values = None,
    state: Values = None,
    step: float = 1.0,
) -> Vector:
    """d(rates)/d(states), by steps of the states from `state`."""

    def rates(state: Mapping[str, float]) -> Vector:
        return np.array(list(rates_of(component, parameters, state, inputs).values()))

    base, values = rates(state or {}), component.state.named(component.state.vector(state))
    columns = [rates({**values, name: value + step}) - base for name, value in values.items()]
    return np.array(columns).T / step


def find_whirl(matrix: Vector, x: int, y: int) -> Vector:
    """Angular frequencies of an undamped shaft from d(rates)/d(states), ascending: positive where it whirls
    anticlockwise, from axis x to y, given the places of two displacements along them among the states."""
    values, vectors = np.linalg.eig(matrix)
    moving = (values.imag > 0.0) & (np.abs(vectors[x]) > 1e-9 * np.abs(vectors).max(axis=0))
    # x = cos(w t) and y = sin(w t) are the real parts of exp(i w t) and -i exp(i w t).
    turned = np.imag(vectors[y, moving] / vectors[x, moving])
    return np.sort(-np.sign(turned) * values.imag[moving])


def march_alone(problem: Any, x0: Vector, times: Vector, t0: float = 0.0, tolerance: float = 1e-9) -> Vector:
    """States and energies at `times` by the reference's first method alone."""
    z = problem.start(x0)
    stiff, longest = stiffness(problem, t0, z, times)
    return march(problem, Cvode(problem, tolerance, stiff, longest), z, t0, times)[0]


def run(problem: Any, x0: Vector, times: Vector, t0: float = 0.0, tolerance: float = 1e-9) -> Vector:
    """Outputs (n, n_out) at `times` by the reference's first method alone."""
    return observe(problem.evaluation, times, march_alone(problem, x0, times, t0, tolerance))[1]
