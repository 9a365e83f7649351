"""The choice of a master before a run; what it needs is imported only then."""

from ...reporter import Reporter
from ...scenario import ScenarioError
from ...scenario.capabilities import list_foreign
from ...scenario.master_table import AUTO, MasterTable
from ...scenario.system import Resolved


def choose_master(resolved: Resolved, reporter: Reporter) -> Resolved:
    """The scenario with what `auto` chooses for it; one with another master as it is."""
    if resolved.scenario.master.name != AUTO:
        return resolved
    from .choice import choose

    return choose(resolved, reporter)


def choose_unnamed(resolved: Resolved, reporter: Reporter) -> Resolved:
    """As `choose_master`, also where no master is named and something is coupled.

    If nothing can be chosen by trials there, the default runs, and its table says why.
    """
    scenario = resolved.scenario
    if scenario.names_master or not resolved.system.connections:
        return choose_master(resolved, reporter)
    why = "; ".join(list_foreign(scenario)) or "there is no tolerance to choose it for"
    if scenario.tolerance and not list_foreign(scenario):
        from .choice import choose

        try:
            return choose(resolved, reporter)
        except ScenarioError as error:
            why = str(error).partition(f"{AUTO!r}: ")[2].partition("; name a master")[0]
    said = f"no master is named, and none is chosen ({why}): gauss_seidel with linear signals"
    changes = {"master": MasterTable(chosen=said)}
    return resolved.with_master_of(scenario.model_copy(update=changes))
