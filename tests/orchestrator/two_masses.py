"""A linear two-mass oscillator as two components, with its exact solution.

Mass 1 hangs on the ground by k1, d1; the coupling spring k12, d12 belongs to mass 1, which gives its
force; mass 2 is driven by that force, has k2, d2 to the ground, and gives position and velocity: a
force-displacement split. Both subsystems are integrated to 1e-10, so what is seen is the coupling.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Any

import numpy as np
from scipy.linalg import expm

from models.component import Component, PowerBond
from models.kernel import kernel
from models.quantities import Layout, Quantity, Vector
from models.system import Instance, System


@dataclass
class MassParameters:
    mass: Annotated[float, Quantity("kg", "mass", positive=True)] = 1.0
    stiffness: Annotated[float, Quantity("N/m", "spring to the ground")] = 10.0
    damping: Annotated[float, Quantity("N.s/m", "damper to the ground")] = 0.5
    coupling_stiffness: Annotated[float, Quantity("N/m", "spring to the other mass")] = 40.0
    coupling_damping: Annotated[float, Quantity("N.s/m", "damper to the other mass")] = 1.0


@dataclass
class MassState:
    position: Annotated[float, Quantity("m", "position")] = 0.0
    velocity: Annotated[float, Quantity("m/s", "velocity")] = 0.0


@dataclass
class MotionInputs:
    other_position: Annotated[float, Quantity("m", "position of the other mass")] = 0.0
    other_velocity: Annotated[float, Quantity("m/s", "velocity of the other mass")] = 0.0


@dataclass
class ForceInputs:
    force: Annotated[float, Quantity("N", "force")] = 0.0


@dataclass
class ForceOutputs:
    force: Annotated[float, Quantity("N", "force on the other mass", nominal=10.0)] = 0.0
    position: Annotated[float, Quantity("m", "position")] = 0.0


@dataclass
class MotionOutputs:
    position: Annotated[float, Quantity("m", "position")] = 0.0
    velocity: Annotated[float, Quantity("m/s", "velocity")] = 0.0


@kernel
def coupling_force(x: Any, u: Any, p: Any) -> float:
    spring = p.coupling_stiffness * (x.position - u.other_position)
    return spring + p.coupling_damping * (x.velocity - u.other_velocity)


@kernel
def first_derivative(t: float, x: Any, u: Any, p: Any, dx: Any) -> None:
    dx.position = x.velocity
    force = p.stiffness * x.position + p.damping * x.velocity + coupling_force(x, u, p)
    dx.velocity = -force / p.mass


@kernel
def first_output(t: float, x: Any, u: Any, p: Any, y: Any) -> None:
    y.force = coupling_force(x, u, p)
    y.position = x.position


@kernel
def second_derivative(t: float, x: Any, u: Any, p: Any, dx: Any) -> None:
    dx.position = x.velocity
    dx.velocity = (u.force - p.stiffness * x.position - p.damping * x.velocity) / p.mass


@kernel
def second_output(t: float, x: Any, u: Any, p: Any, y: Any) -> None:
    y.position = x.position
    y.velocity = x.velocity


@kernel
def no_energy(t: float, x: Any, u: Any, p: Any, e: Any) -> None:
    e[0] = e[1] = e[2] = 0.0


def _component(
    name: str, inputs: type, outputs: type, derivative: Any, output: Any, through: Any
) -> Component:
    return Component(
        name=name,
        description=name,
        parameters=Layout(MassParameters),
        state=Layout(MassState),
        inputs=Layout(inputs),
        outputs=Layout(outputs),
        derivative=derivative,
        output=output,
        energy=no_energy,
        feedthrough=through,
        bonds=(PowerBond("force", "velocity", 1),) if inputs is ForceInputs else (),
    )


FIRST = _component(
    "first_mass",
    MotionInputs,
    ForceOutputs,
    first_derivative,
    first_output,
    {"force": ("other_position", "other_velocity")},
)
SECOND = _component("second_mass", ForceInputs, MotionOutputs, second_derivative, second_output, {})


def two_masses(**parameters: float) -> System:
    """Both masses with the same given parameters; mass 1 starts deflected by 1 m."""
    return System(
        {
            "first": Instance(FIRST, parameters, {"position": 1.0}),
            "second": Instance(SECOND, parameters),
        },
        [
            ("first.force", "second.force"),
            ("second.position", "first.other_position"),
            ("second.velocity", "first.other_velocity"),
        ],
    )


def exact(times: Vector, **parameters: float) -> Vector:
    """Positions of both masses, (n, 2), by the matrix exponential."""
    p = MassParameters(**parameters)
    k, d, kc, dc, m = p.stiffness, p.damping, p.coupling_stiffness, p.coupling_damping, p.mass
    a = np.array(
        [
            [0, 1, 0, 0],
            [-(k + kc) / m, -(d + dc) / m, kc / m, dc / m],
            [0, 0, 0, 1],
            [kc / m, dc / m, -(k + kc) / m, -(d + dc) / m],
        ]
    )
    start = np.array([1.0, 0.0, 0.0, 0.0])
    return np.array([(expm(a * t) @ start)[[0, 2]] for t in times])
