"""The reference of a run: its equations solved without splitting, or the limit of runs with smaller steps."""

from __future__ import annotations

import time as clock
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from models.core.difference import Difference
from models.core.quantities import Vector

from ..participants.description import MODEL_EXCHANGE
from ..participants.model_exchange import FmuEquations, open_equations
from ..participants.open_fmu import collect_settings
from ..reporter import Reporter
from .plan import BY_PARTS, MONOLITHIC, REFINEMENT, Plan, ReferencePlan
from .refinement import describe_doubts, refine

if TYPE_CHECKING:
    from models.monolithic import Reference


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
    plan: Plan,
    wanted: ReferencePlan,
    ends: Vector,
    times: Vector,
    coupled: Mapping[str, Vector],
    reporter: Reporter,
) -> Solution:
    """The reference at `times`, where the run's outputs are `coupled`. ModelError or RunError if it fails.

    The run began, and parts of its steps ended, at `ends`.
    """
    began = clock.perf_counter()
    if wanted.method == REFINEMENT:
        refined = refine(plan, ends, times, coupled, reporter)
        return Solution(
            times,
            refined.outputs,
            refined.uncertainty,
            clock.perf_counter() - began,
            REFINEMENT,
            refined.orders,
            describe_doubts(refined, plan.tolerance),
        )
    if wanted.method == BY_PARTS:
        return _solve_by_parts(plan, wanted.tolerance, times, reporter, began)
    from models.monolithic import LONGEST_STEP, solve

    system = plan.system
    with reporter.stage("monolithic reference", plan.stop_time) as bar:
        found = solve(
            system,
            times,
            tolerance=wanted.tolerance,
            x0=system.x0,
            progress=bar.show,
            longest_step=wanted.step or LONGEST_STEP,
        )
    return Solution(found.times, found.outputs, found.uncertainty, found.wall_time_s, reference=found)


def _solve_by_parts(
    plan: Plan, tolerance: float, times: Vector, reporter: Reporter, began: float
) -> Solution:
    from models.monolithic.reference import uncertainties

    from .equations import solve_equations

    system = plan.system

    def open_fmus() -> dict[str, FmuEquations]:
        opened: dict[str, FmuEquations] = {}
        try:
            for name, component in plan.third_party.items():
                instance, how = system.instances[name], plan.participants[name]
                assert how.file
                settings = collect_settings(instance, how.strings)
                settings = replace(settings, interface=MODEL_EXCHANGE)
                inputs = tuple(n for n in component.inputs.names if n not in instance.inputs)
                opened[name] = open_equations(name, how.file.path, settings, inputs, how.limits)
        except BaseException:
            for fmu in opened.values():
                fmu.close()
            raise
        return opened

    linear = {name: how.linear for name, how in plan.participants.items()}
    with reporter.stage("monolithic reference", plan.stop_time) as bar:
        found = solve_equations(system, open_fmus, linear, times, plan.stop_time, tolerance, bar.show)
    uncertainty = uncertainties(system, times, found.outputs, found.others)
    seconds = clock.perf_counter() - began
    return Solution(times, found.outputs, uncertainty, seconds, doubts=_describe_solvers(plan))


def _describe_solvers(plan: Plan) -> str:
    """The end of a verdict where FMUs of others take part."""
    stepping = [name for name, component in plan.third_party.items() if not component.about.integrated]
    if not stepping:
        return ""
    return (
        f"; this includes the errors of the own solvers of {', '.join(stepping)}: interface = "
        "'model_exchange' integrates their equations here instead, reference.method = 'refinement' shows the "
        "errors of the coupling alone"
    )
