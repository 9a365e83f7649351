"""What is said of a scenario before it runs or is studied."""

from models.core.system import System

from ..scenario import Scenario
from ..scenario.system import build_system
from ..scenario.warnings import list_inherited, list_oils, list_warnings
from .springs import remark_default_bind, remark_masses, warn_of_solid


def list_notices(scenario: Scenario) -> list[str]:
    """What its files leave open, and what is doubted of it, a line each."""
    system = build_system(scenario)
    return [*list_changes(scenario, system), *list_doubts(scenario, system)]


def list_changes(scenario: Scenario, system: System) -> list[str]:
    """What a scenario has from those that it extends, and what the command's changes leave as it is. A run
    that is resumed has its scenario in one file."""
    changed = scenario.origin.changed if scenario.origin else ()
    return [*list_inherited(scenario), *remark_masses([system], changed)]


def list_doubts(scenario: Scenario, system: System) -> list[str]:
    """What each oil has at its temperature, and all warnings."""
    springs = *warn_of_solid(system), *remark_default_bind(system)
    return [*list_oils(scenario), *list_warnings(scenario), *springs]
