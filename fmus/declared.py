"""What is declared of a component's FMU: here for ours, in its module for a user's own."""

import importlib
from typing import Any

from models.catalogue import find_factory, is_own

from .fmi.description import Experiment

# Default experiments of tools, where they are not two turns at 1000 r/min.
EXPERIMENTS = {
    "camshaft": Experiment(0.24, 1e-5),  # two turns of the cam
    "rod": Experiment(0.02, 2e-6),  # two hundred periods of the default rod between rigid ends
    "slider_crank": Experiment(0.6, 1e-5),  # ten turns
    "free_piston_crank": Experiment(0.2, 1e-5),
    "flywheel": Experiment(1.0, 1e-3),
    "quarter_car_chassis": Experiment(4.0, 1e-3),
    "quarter_car_wheel": Experiment(4.0, 1e-3),
    "coupled_mass": Experiment(10.0, 1e-3),
    "sprung_mass": Experiment(10.0, 1e-3),
    "falling_mass": Experiment(1.0, 1e-4),
    "spring_stop": Experiment(1.0, 1e-4),
    "planes": Experiment(1.0, 0.01),
    "sphere": Experiment(1.0, 0.01),
}
PYTHON_ONLY = {
    "ehl_line_contact": "its pressure field needs Python; take the FMU in Python, or ehl_contact with a film "
    "formula",
}


def explain_no_native(name: str) -> str:
    """Why there is no native FMU of the component, and no model exchange; "" if there is one."""
    return str(_find_own(name, "PYTHON_ONLY", "")) if is_own(name) else PYTHON_ONLY.get(name, "")


def experiment(name: str) -> Experiment:
    """The default experiment of tools."""
    if not is_own(name):
        return EXPERIMENTS.get(name, Experiment(0.12, 1e-5))
    return Experiment(*_find_own(name, "EXPERIMENT", (1.0, 1e-3)))


def _find_own(name: str, constant: str, default: Any) -> Any:
    """A constant of the module of a user's own component."""
    return getattr(importlib.import_module(find_factory(name).__module__), constant, default)
