"""The scenario: everything that a run depends on. `scenario_files` reads it, `assembly` builds it."""

from __future__ import annotations

from .component_table import BUILT, ComponentTable
from .connection import Line, ends, line_of
from .fields import Written
from .master_table import MasterTable
from .messages import messages
from .revolutions import DURATIONS
from .scenario import EnergyTable, Scenario, ScenarioError, elsewhere, scenario_of
from .step_control_table import CONVERGED

__all__ = [
    "BUILT",
    "CONVERGED",
    "DURATIONS",
    "ComponentTable",
    "EnergyTable",
    "Line",
    "MasterTable",
    "Scenario",
    "ScenarioError",
    "Written",
    "elsewhere",
    "ends",
    "line_of",
    "messages",
    "scenario_of",
]
