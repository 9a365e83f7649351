"""What is said of a scenario before it runs or is studied."""

from ..scenario import Scenario
from ..scenario.system import build_system
from ..scenario.warnings import list_inherited, list_oils, list_warnings
from .springs import remark_default_bind, remark_masses, warn_of_solid


def list_notices(scenario: Scenario) -> list[str]:
    """What its files leave open, and what is doubted of it, a line each."""
    return [*list_changes(scenario), *list_doubts(scenario)]


def list_changes(scenario: Scenario) -> list[str]:
    """What a scenario has from those that it extends, and what the command's changes leave as it is. A run
    that is resumed has its scenario in one file."""
    changed = scenario.origin.changed if scenario.origin else ()
    return [*list_inherited(scenario), *remark_masses([build_system(scenario)], changed)]


def list_doubts(scenario: Scenario) -> list[str]:
    """What each oil has at its temperature, and all warnings."""
    system = build_system(scenario)
    springs = *warn_of_solid(system), *remark_default_bind(system)
    return [*list_oils(scenario), *list_warnings(scenario), *springs]
