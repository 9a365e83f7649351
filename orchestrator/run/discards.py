"""A run in which a participant discards a step is made again, with steps of its own for that participant."""

from dataclasses import replace

from ..reporter import Reporter
from ..scenario.capabilities import plan_proof
from ..scenario.files import to_full_toml
from ..store import atomic_write
from ..store.output_folder import SCENARIO, OutputFolder, clear_run_state
from .execute import Checkpoint, execute
from .plan import Plan
from .summary import Summary

# How often a discarded step is halved: down to a thousandth.
RETRIES = 10


def execute_with_retries(
    plan: Plan, folder: OutputFolder, reporter: Reporter, checkpoint: Checkpoint | None = None
) -> tuple[Plan, Summary]:
    """As `execute`, then from the start; the plan that was executed at last is that of the folder's
    scenario.toml.

    A participant that discards a step is given `retries`, unless the scenario does, steps are made again for
    their error, or it takes steps of one length only. The others keep the macro step.
    """
    summary = execute(plan, folder, reporter, checkpoint)
    while again := _retry(plan, summary.discarding):
        plan = again
        reporter.line(plan.notices[-1])
        clear_run_state(folder.unfinished)
        atomic_write.write_whole(folder.path / SCENARIO, plan.toml.encode())
        summary = execute(plan, folder, reporter)
    return plan, summary


def _retry(plan: Plan, name: str) -> Plan | None:
    table, control = plan.scenario.components.get(name), plan.scenario.step_control
    if table is None or table.retries is not None or (control and not control.forward):
        return None
    if table.file and not table.describe().variable_step:
        return None
    tables = plan.scenario.components | {name: table.model_copy(update={"retries": RETRIES})}
    scenario = plan.scenario.model_copy(update={"components": tables})
    own = replace(plan.participants[name], retries=RETRIES, proof=plan_proof(scenario, name))
    said = (
        f"{name} discards a step: the run begins again, and {name} halves what it discards up to {RETRIES} "
        f"times; the others keep the macro step (components.{name}.retries = {RETRIES})"
    )
    return replace(
        plan,
        scenario=scenario,
        toml=to_full_toml(scenario),
        participants={**plan.participants, name: own},
        notices=[*plan.notices, said],
    )
