"""`[master] name = "auto"` before a run; what it needs is imported only then."""

from ...reporter import Reporter
from ...scenario import Scenario
from ...scenario.master_table import AUTO


def choose_master(scenario: Scenario, reporter: Reporter) -> Scenario:
    """The scenario with what `auto` chooses for it; another scenario as it is."""
    if scenario.master.name != AUTO:
        return scenario
    from .choice import choose

    return choose(scenario, reporter)
