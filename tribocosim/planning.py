"""Plans of runs: scenarios resolved once, for runs and sessions that repeat."""

from pathlib import Path

from orchestrator.analyses.stability.chosen import choose_unnamed
from orchestrator.reporter import Reporter
from orchestrator.run.plan import Plan, make_plan
from orchestrator.scenario import Scenario as CheckedScenario
from orchestrator.scenario.system import resolve

from .arguments import checks_arguments
from .cached_fmus import build_fmu, check_native
from .reporting import Progress, SilentReporter
from .scenario import Scenario, load


@checks_arguments
def plan(scenario: Scenario | str | Path, *, figures: bool = False, progress: Progress | None = None) -> Plan:
    """Resolve a scenario: check it, build its FMUs and find its start values.

    `execute` runs the plan, and `session` steps it, as often as you like. `figures` are drawn by `execute`
    into its folder. MistakeError for a fault of the scenario.
    """
    return resolve_run(load(scenario).check(), SilentReporter(progress), figures)


def resolve_run(checked: CheckedScenario, reporter: Reporter, figures: bool) -> Plan:
    """The plan of a checked scenario, which speaks to the reporter; `auto` chooses its master,
    if it is asked or none is named."""
    check_native(checked)
    resolved = resolve(checked)
    chosen = choose_unnamed(resolved, reporter)
    return make_plan(chosen, build_fmu, reporter, figures)
