"""The two-mass oscillator with equal masses, as tests of the masters use it.

Both subsystems are integrated to 1e-10, so what is seen is the coupling.
"""

import numpy as np

from models.core.quantities import Vector
from models.core.system import Instance, System
from models.oscillators.two_masses import (
    CoupledMassParameters,
    SprungMassParameters,
    coupled_mass,
    sprung_mass,
)
from tests.models import exact_oscillators as solutions

FIRST, SECOND = coupled_mass(), sprung_mass()
START = np.array([1.0, 0.0, 0.0, 0.0])


def two_masses(**parameters: float) -> System:
    """Both masses with the same given parameters; mass 1 starts deflected by 1 m."""
    return System(
        {
            "first": Instance(FIRST, parameters, {"position": 1.0}),
            "second": Instance(SECOND, _of_second(parameters)),
        },
        [
            ("first.force", "second.force"),
            ("second.position", "first.other_position"),
            ("second.velocity", "first.other_velocity"),
        ],
    )


def exact(times: Vector, **parameters: float) -> Vector:
    """Positions of both masses, (n, 2), by the matrix exponential."""
    first, second = CoupledMassParameters(**parameters), SprungMassParameters(**_of_second(parameters))
    return solutions.two_masses(times, first, second, START)[:, [0, 2]]


def _of_second(parameters: dict[str, float]) -> dict[str, float]:
    return {name: value for name, value in parameters.items() if name in SECOND.parameters}
