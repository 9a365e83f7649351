"""Two masses: one of our components, and an FMU in C that is coupled with it."""

from pathlib import Path
from typing import Any

import numpy as np

from models.oscillators.two_masses import CoupledMassParameters, SprungMassParameters
from orchestrator.scenario import Scenario
from tests.models.exact_oscillators import two_masses

from .c_fmus import fmu
from .runs import scenario

LINES = [
    "first.force -> second.force",
    "second.position -> first.other_position",
    "second.velocity -> first.other_velocity",
]


def masses(second: str, folder: Path, component: str | None = None, **changes: Any) -> Scenario:
    """The second one is that FMU, in the place of our `component` if one is given; the first one starts at
    1 m."""
    tables = {
        "first": {"component": "coupled_mass", "participant": "in-process", "start": {"position": 1.0}},
        "second": {"participant": fmu(second, 2, folder), "component": component},
    }
    return scenario(tables, **{"connections": LINES} | changes)


def exact_position(times: np.ndarray) -> np.ndarray:
    """That of the first one by the matrix exponential."""
    coupled, sprung = CoupledMassParameters(), SprungMassParameters(mass=1.0, stiffness=10.0, damping=0.5)
    return two_masses(times, coupled, sprung, np.array([1.0, 0.0, 0.0, 0.0]))[:, 0]
