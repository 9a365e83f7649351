"""What is said of a scenario before it runs or is studied."""

from ..scenario import Scenario
from ..scenario.system import build_system
from ..scenario.warnings import list_oils, list_warnings
from .springs import remark_default_bind, remark_masses, warn_of_solid


def list_notices(scenario: Scenario) -> list[str]:
    """What each oil has at its temperature, and all warnings, a line each."""
    system = build_system(scenario)
    changed = scenario.origin.changed if scenario.origin else ()
    springs = *warn_of_solid(system), *remark_default_bind(system), *remark_masses([system], changed)
    return [*list_oils(scenario), *list_warnings(scenario), *springs]
