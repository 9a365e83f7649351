"""The reference of a run: its equations solved without splitting, or the limit of runs with smaller steps.

A reference by refinement, for systems whose equations are unknown: the run again with smaller macro steps.

The steps are those that the run took, each halved and quartered: of one length, or as long as step control
made them. So all errors fall with one power. Where the error of a run with macro steps h is C h^p, three runs
with h, h/2 and h/4 give p and the limit:

    p = log2(|y_h - y_h/2| / |y_h/2 - y_h/4|)             by root mean squares over time
    y = y_h/4 + (y_h/4 - y_h/2) / (2^p - 1)               Richardson's extrapolation

The uncertainty is the larger of two differences: to the extrapolation from y_h and y_h/2, and to that with
the nearest whole order. The reference sees the error of the coupling only: what the FMUs' own solvers miss is
in all three runs.
"""

from __future__ import annotations

import math
import time as clock
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from models.core.difference import Difference, difference, time_weights
from models.core.quantities import Vector

from ..engine.observer import Observer
from ..engine.step import Step
from ..participants.description import MODEL_EXCHANGE
from ..participants.model_exchange.in_own_process import FmuEquations, open_equations
from ..participants.open_fmu import collect_settings
from ..reporter import REFERENCE, Reporter
from ..scenario.capabilities import BY_PARTS, MONOLITHIC, REFINEMENT
from .plan import Plan, open_participants
from .simulation import simulate

if TYPE_CHECKING:
    from models.monolithic import Reference

# Orders of convergence that are believed; the signals have orders 1 to 4.
LOWEST, HIGHEST = 0.5, 6.0
# Share of a step by which an event just before its end may take its place.
SLACK = 1e-6


@dataclass(frozen=True)
class Solution:
    """All outputs (rows x outputs) at `times`, and the uncertainty of each.

    `orders` are those of convergence, by refinement; NaN where there is none. `doubts` ends the verdict.
    `solvers` are the FMUs whose own solvers' errors are seen against it. `reference` is that of
    `models.monolithic`, where all components are ours.
    """

    times: Vector
    outputs: Vector
    uncertainty: Mapping[str, Difference]
    wall_time_s: float = 0.0
    method: str = MONOLITHIC
    orders: Mapping[str, float] | None = None
    doubts: str = ""
    solvers: Sequence[str] = ()
    reference: Reference | None = None


def _refine(
    plan: Plan, ends: Vector, times: Vector, coarse: Mapping[str, Vector], reporter: Reporter
) -> Solution:
    """Repeat the run, whose steps, or parts of them, have these `ends`, with each halved and quartered.

    `ends` has the start too. The `coarse` outputs are those at `times`, which are some of them.
    """
    half, quarter = (_repeat(plan, ends, parts, times, reporter) for parts in (2, 4))
    names, weights = plan.system.outputs.names, time_weights(times)
    limit, uncertainty, orders = quarter.copy(), {}, {}
    for i, (name, nominal) in enumerate(zip(names, plan.system.outputs.nominal, strict=True)):
        extrapolated = extrapolate(coarse[name], half[:, i], quarter[:, i], weights)
        limit[:, i], other, orders[name] = extrapolated
        uncertainty[name] = difference(other, limit[:, i], nominal, weights)
    doubts = _describe_doubts(uncertainty, orders, plan.tolerance)
    return Solution(times, limit, uncertainty, method=REFINEMENT, orders=orders, doubts=doubts)


def extrapolate(
    coarse: Vector, half: Vector, quarter: Vector, weights: Vector
) -> tuple[Vector, Vector, float]:
    """The limit, another estimate of it that is less exact, and the order of convergence.

    Without a clear order (NaN) these are the finest and the coarsest run.
    """
    first, second = coarse - half, half - quarter
    larger, smaller = (
        math.sqrt(np.average(np.square(change), weights=weights)) for change in (first, second)
    )
    order = math.log2(larger / smaller) if larger > 0.0 and smaller > 0.0 else math.nan
    if not LOWEST < order < HIGHEST:
        return quarter, coarse, math.nan
    gain, whole = 2.0**order - 1.0, 2.0 ** round(max(order, 1.0)) - 1.0
    limit = quarter - second / gain
    others = half - first / gain, quarter - second / whole
    return (
        limit,
        max(others, key=lambda other: float(np.average((other - limit) ** 2, weights=weights))),
        order,
    )


def _describe_doubts(
    uncertainty: Mapping[str, Difference], orders: Mapping[str, float], tolerance: Mapping[str, float]
) -> str:
    """The end of a verdict: variables without a clear order, and what such a reference does not see.

    These are named if their runs differ by more than a tenth of what is allowed.
    """
    doubtful = [
        name
        for name, allowed in tolerance.items()
        if math.isnan(orders[name]) and uncertainty[name].relative_rms > 0.1 * allowed
    ]
    unseen = "; the errors of the FMUs' own solvers are in all runs and not seen"
    if not doubtful:
        return unseen
    return (
        f"; {', '.join(doubtful)}: the runs with smaller steps do not converge with a clear order, so the "
        "error is only about the difference of the runs; reduce macro_step or, where that does not help, the "
        f"tolerances of the FMUs' own solvers{unseen}"
    )


def _repeat(plan: Plan, ends: Vector, parts: int, times: Vector, reporter: Reporter) -> Vector:
    """All outputs at `times` of a run with that many steps for each."""
    lengths = np.diff(ends, prepend=ends[0])[np.searchsorted(ends, times)]
    samples = _Samples(times, SLACK * lengths / parts)
    steps, stop = plan.refine_steps(ends, parts), plan.stop_time
    with (
        reporter.stage(f"coupled run again, each step divided by {parts}", stop) as bar,
        open_participants(plan.system, plan.participants) as participants,
    ):
        simulate(plan.system, participants, plan.master, steps, stop, [samples, bar], lines=plan.side_lines)
    return np.array(samples.rows)


class _Samples(Observer):
    """An observer that keeps all outputs at given times, each met within its slack."""

    def __init__(self, times: Vector, slack: Vector) -> None:
        self._due = times - slack
        self.rows: list[Vector] = []

    def observe(self, time: float, outputs: Callable[[], Vector], step: Step) -> None:
        if len(self.rows) < len(self._due) and time >= self._due[len(self.rows)]:
            self.rows.append(outputs().copy())


def solve_reference(
    plan: Plan,
    ends: Vector,
    times: Vector,
    coupled: Mapping[str, Vector],
    reporter: Reporter,
) -> Solution:
    """The reference at `times`, where the run's outputs are `coupled`. ModelError or RunError if it fails.

    The run began, and parts of its steps ended, at `ends`.
    """
    began = clock.perf_counter()
    if plan.reference == REFINEMENT:
        found = _refine(plan, ends, times, coupled, reporter)
    elif plan.reference == BY_PARTS:
        found = _solve_by_parts(plan, times, reporter)
    else:
        found = _solve_whole(plan, times, reporter)
    return replace(found, wall_time_s=found.wall_time_s or clock.perf_counter() - began)


def _solve_whole(plan: Plan, times: Vector, reporter: Reporter) -> Solution:
    from models.monolithic import LONGEST_STEP, solve

    with reporter.stage(REFERENCE, plan.stop_time) as bar:
        found = solve(
            plan.system,
            times,
            tolerance=plan.scenario.reference.tolerance,
            x0=plan.system.x0,
            progress=bar.show,
            longest_step=plan.scenario.reference.step or LONGEST_STEP,
            counts_energies=False,
        )
    return Solution(found.times, found.outputs, found.uncertainty, found.wall_time_s, reference=found)


def _solve_by_parts(plan: Plan, times: Vector, reporter: Reporter) -> Solution:
    from models.monolithic.reference import uncertainties

    from ..participants.model_exchange.problem import solve_equations

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
    tolerance = plan.scenario.reference.tolerance
    with reporter.stage(REFERENCE, plan.stop_time) as bar:
        found = solve_equations(system, open_fmus, linear, times, plan.stop_time, tolerance, bar.show)
    uncertainty = uncertainties(system, times, found.outputs, found.others)
    stepping = [name for name, component in plan.third_party.items() if not component.about.integrated]
    seen = f"; this includes the errors of the own solvers of {', '.join(stepping)}" if stepping else ""
    return Solution(times, found.outputs, uncertainty, doubts=seen, solvers=stepping)


def measure_orders(
    plan: Plan,
    ends: Vector,
    coupled: Mapping[str, Vector],
    solution: Solution,
    names: Iterable[str],
    reporter: Reporter,
) -> Mapping[str, float]:
    """With which power of the steps the errors of these variables fall, by the run again with halved ones."""
    halved = _repeat(plan, ends, 2, solution.times, reporter)
    known, weights = plan.system.outputs.names, time_weights(solution.times)
    found = {}
    for i, name in ((known.index(name), name) for name in names):
        whole, half = (
            difference(values, solution.outputs[:, i], weights=weights).rms
            for values in (coupled[name], halved[:, i])
        )
        found[name] = float(np.log2(whole) - np.log2(half)) if half else HIGHEST
    return found
