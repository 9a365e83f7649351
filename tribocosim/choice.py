"""`[master] name = "auto"` before a run; what it needs is imported only then."""

from orchestrator.reporter import Reporter
from orchestrator.scenario import Scenario
from orchestrator.scenario.master_table import AUTO


def choose_master(scenario: Scenario, reporter: Reporter) -> Scenario:
    """The scenario with what `auto` chooses for it; another scenario as it is."""
    if scenario.master.name != AUTO:
        return scenario
    from orchestrator.analyses.stability.choice import choose

    return choose(scenario, reporter)
