"""Plans of runs: scenarios resolved once, for runs and sessions that repeat."""

from pathlib import Path

from orchestrator.analyses.stability.chosen import choose_master
from orchestrator.run.plan import Plan, make_plan

from .cached_fmus import build_fmu, check_native
from .reporting import Progress, SilentReporter
from .scenario import Scenario, load


def plan(scenario: Scenario | str | Path, *, figures: bool = False, progress: Progress | None = None) -> Plan:
    """Resolve a scenario: check it, build its FMUs and find its start values.

    `execute` runs the plan, and `session` steps it, as often as you like. `figures` are drawn by `execute`
    into its folder. MistakeError for a fault of the scenario.
    """
    checked = load(scenario).check()
    check_native(checked)
    reporter = SilentReporter(progress)
    return make_plan(choose_master(checked, reporter), build_fmu, reporter, figures)
