"""Scenarios: tables, files, units, checks, warnings and the JSON schema."""

from .component_table import BUILT_KINDS, ComponentTable
from .connection import Line, parse_ends, parse_line
from .fields import Written
from .master_table import CONVERGED, MasterTable
from .messages import find_faults
from .revolutions import DURATIONS
from .scenario import EnergyTable, Scenario, ScenarioError, build_scenario, find_tables

__all__ = [
    "BUILT_KINDS",
    "CONVERGED",
    "DURATIONS",
    "ComponentTable",
    "EnergyTable",
    "Line",
    "MasterTable",
    "Scenario",
    "ScenarioError",
    "Written",
    "build_scenario",
    "find_faults",
    "find_tables",
    "parse_ends",
    "parse_line",
]  # fmt: skip
