"""`[master] name = "auto"` before a run; what it needs is imported only then."""

from ...reporter import Reporter
from ...scenario.master_table import AUTO
from ...scenario.system import Resolved


def choose_master(resolved: Resolved, reporter: Reporter) -> Resolved:
    """The scenario with what `auto` chooses for it; another scenario as it is."""
    if resolved.scenario.master.name != AUTO:
        return resolved
    from .choice import choose

    return choose(resolved, reporter)
