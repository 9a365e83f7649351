"""The reference of a run: its equations solved without splitting, or the limit of runs with smaller steps."""

from __future__ import annotations

import time as clock
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from models.core.difference import Difference
from models.core.quantities import Vector

from ..participants import ThirdPartyComponent, collect_settings
from ..participants.description import MODEL_EXCHANGE
from ..participants.model_exchange import FmuEquations, open_equations
from ..reporter import Reporter
from ..scenario import Scenario
from ..scenario.capabilities import is_refined, is_solved_by_parts
from ..scenario.conversion import find_transformations
from ..scenario.system import build_instances
from .plan import Plan
from .refinement import describe_doubts, refine

if TYPE_CHECKING:
    from models.monolithic import Reference

MONOLITHIC, REFINEMENT = "monolithic", "refinement"


@dataclass(frozen=True)
class Solution:
    """All outputs (rows x outputs) at `times`, and the uncertainty of each.

    `orders` are those of convergence, by refinement; `doubts` ends the verdict. `reference` is that of
    `models.monolithic`, where all components are ours.
    """

    times: Vector
    outputs: Vector
    uncertainty: Mapping[str, Difference]
    wall_time_s: float
    method: str = MONOLITHIC
    orders: Mapping[str, float] | None = None
    doubts: str = ""
    reference: Reference | None = None


def solve_reference(
    plan: Plan, ends: Vector, times: Vector, coupled: Mapping[str, Vector], reporter: Reporter
) -> Solution:
    """The reference at `times`, where the run's outputs are `coupled`. ModelError or RunError if it fails.

    The run began, and parts of its steps ended, at `ends`.
    """
    began, scenario = clock.perf_counter(), plan.scenario
    if is_refined(scenario):
        refined = refine(plan, ends, times, coupled, reporter)
        return Solution(
            times,
            refined.outputs,
            refined.uncertainty,
            clock.perf_counter() - began,
            REFINEMENT,
            refined.orders,
            describe_doubts(refined, scenario.tolerance),
        )
    if is_solved_by_parts(scenario):
        return _solve_by_parts(plan, times, reporter, began)
    from models.monolithic import LONGEST_STEP, solve

    table, system = scenario.reference, plan.system
    with reporter.stage("monolithic reference", scenario.stop_time) as bar:
        found = solve(
            system,
            times,
            tolerance=table.tolerance,
            x0=system.x0,
            progress=bar.show,
            longest_step=table.step or LONGEST_STEP,
        )
    return Solution(found.times, found.outputs, found.uncertainty, found.wall_time_s, reference=found)


def _solve_by_parts(plan: Plan, times: Vector, reporter: Reporter, began: float) -> Solution:
    from models.monolithic.reference import uncertainties

    from .equations import solve_equations

    scenario, system = plan.scenario, plan.system
    instances, lines = build_instances(scenario)

    def open_fmus() -> dict[str, FmuEquations]:
        opened: dict[str, FmuEquations] = {}
        try:
            for name, instance in instances.items():
                if isinstance(instance.component, ThirdPartyComponent):
                    table = scenario.components[name]
                    settings = collect_settings(instance, table.strings, table.memory_limit_mb)
                    settings = replace(settings, interface=MODEL_EXCHANGE)
                    inputs = tuple(n for n in instance.component.inputs.names if n not in instance.inputs)
                    path = plan.fmus[name].path
                    opened[name] = open_equations(name, path, settings, inputs, table.own_process)
        except BaseException:
            for fmu in opened.values():
                fmu.close()
            raise
        return opened

    with reporter.stage("monolithic reference", scenario.stop_time) as bar:
        found = solve_equations(
            system,
            open_fmus,
            find_transformations(instances, lines),
            times,
            scenario.stop_time,
            scenario.reference.tolerance,
            bar.show,
        )
    uncertainty = uncertainties(system, times, found.outputs, found.others)
    seconds = clock.perf_counter() - began
    return Solution(times, found.outputs, uncertainty, seconds, doubts=_describe_solvers(scenario))


def _describe_solvers(scenario: Scenario) -> str:
    """The end of a verdict where FMUs of others take part."""
    stepping = [
        name
        for name, table in scenario.components.items()
        if table.third_party and not table.describe().integrated
    ]
    if not stepping:
        return ""
    return (
        f"; this includes the errors of the own solvers of {', '.join(stepping)}: interface = "
        "'model_exchange' integrates their equations here instead, reference.method = 'refinement' shows the "
        "errors of the coupling alone"
    )
