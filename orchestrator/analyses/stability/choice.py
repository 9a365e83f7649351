"""`[master] name = "auto"`: the master, signals and macro steps that keep the tolerance at the least cost.

The survey of the coupling gives, for each method, the largest stable step and the errors of equal steps.
Steps that follow their defect are predicted from the same errors: with steps H instead of equal steps h they
are (H/h)^p times as large, p being the order of the signals.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.ndimage import maximum_filter1d

from models.core.quantities import Vector
from models.core.system import ModelError, System
from models.monolithic.trajectory import Trajectory

from ...assessment.contacts import summarise_rows
from ...errors import MistakeError, RunError, Set
from ...masters import GaussSeidel, Iterated, find_name
from ...reporter import Reporter
from ...scenario import Scenario, ScenarioError
from ...scenario.master_table import AUTO, MasterTable, StepControlTable
from ...scenario.scenario import COMPARED_INTERVALS
from ...scenario.system import Resolved
from ...scenario.units import format_time
from ...stepping.controlled import AIM
from ...stepping.forward import find_extrapolated
from .analyse import survey_scenario
from .behaviour import Behaviour
from .survey import WITHIN, AssessedMethod, Scope, Survey

# Safety factor towards the stability limit: steps that follow their defect become shorter where values swing.
MARGIN = 1.25
# The steps that are made, over those that the error aimed at allows: a step is kept until twice as long a one
# is allowed, and an error is remembered for some steps.
KEPT, REMEMBERED = 0.8, 7
# Steps of a run at least. Without a loop, which could become unstable, only the course of the values limits
# them: twice as many then, as the run's guard takes values that jump in each step for an instability.
LEAST = COMPARED_INTERVALS
# Share of a contact's largest load: with landings of 0.95 and more runs missed the tolerance, 5 to 94 times;
# with one of 0.15 a run kept it.
HARD = 0.25
# Tolerances of the defect that are tried.
TOLERANCES = tuple(10.0 ** (-0.25 * k) for k in range(4, 33))


@dataclass(frozen=True)
class Choice:
    """A method with equal steps (s), or with steps up to that length that keep `relative` for their defect.

    `cost`: participant steps of the whole run, as predicted."""

    method: AssessedMethod
    step: float
    cost: float
    relative: float | None = None


def choose(resolved: Resolved, reporter: Reporter) -> Resolved:
    """The scenario with what `auto` chooses for it.

    ScenarioError, which says why, if nothing can be chosen.
    """
    remedy = "; name a master, e.g. ", Set("master.name", "gauss_seidel")
    scope = Scope((GaussSeidel, Iterated), resolved.scenario.stop_time / LEAST, refuse_impacts)
    try:
        found = survey_scenario(resolved, [], reporter, scope)
    except (MistakeError, ModelError, RunError) as error:
        raise ScenarioError((f"master.name = {AUTO!r}: ", error, remedy)) from None
    best = min(list_choices(found), key=lambda one: one.cost, default=None)
    if best is None:
        none = "no master is stable and within the tolerance at any step tried"
        raise ScenarioError((f"master.name = {AUTO!r}: {none}", remedy))
    return resolved.with_master_of(_apply(found, best))


def refuse_impacts(system: System, motion: Trajectory) -> None:
    """MistakeError if a contact lands hard: the errors that follow depend on the instant of the landing."""

    def read(names: Sequence[str]) -> dict[str, Vector]:
        return {
            name: motion.times if name == "time" else motion.outputs[:, system.outputs.names.index(name)]
            for name in names
        }

    for name, contact in summarise_rows(system, read).items():
        impact = contact.impact
        if impact and impact.load >= HARD * contact.largest_load:
            raise MistakeError(
                f"{name} lands at t = {impact.time:.3g} s with {impact.load:.3g} N, "
                f"{100.0 * impact.load / contact.largest_load:.0f} % of its largest load; the errors after "
                "such an impact cannot be predicted"
            )


def list_choices(found: Survey) -> Iterator[Choice]:
    """The methods with equal steps, and the explicit ones with steps that follow their defect."""
    scenario = found.scenario
    longest = scenario.stop_time / (LEAST if found.partition.loops else 2 * LEAST)
    for method in found.methods:
        stable = min(method.limit / MARGIN, longest)
        step = min(method.safe_step, stable)
        if not (step > 0.0 and math.isfinite(method.cost)) or method.master.extrapolation == "hold":
            continue
        count = math.ceil(scenario.stop_time / step * (1.0 - 1e-9))
        per_step = method.cost * method.advised_step
        yield Choice(method, scenario.stop_time / count, count * per_step)
        if not method.master.implicit and found.limits.variable_step and found.system.connections:
            control = _Defect(found, method).find_tolerance(stable)
            if control is not None:
                relative, mean = control
                yield Choice(method, stable, scenario.stop_time / mean * per_step, relative)


class _Defect:
    """Predicts a method's run with steps that follow their defect."""

    def __init__(self, found: Survey, method: AssessedMethod) -> None:
        self._surveyor, self._method = found.surveyor, method
        self._behaviour: Behaviour = found.surveyor.behave(method.master)
        coupling = self._behaviour.single.coupling
        extrapolated = find_extrapolated(coupling, method.master)
        self._seen = np.flatnonzero(extrapolated[coupling.wiring.connected])
        self._columns = coupling.wiring.connected[self._seen]
        self._count = len(coupling.wiring.connected)

    def find_tolerance(self, longest: float) -> tuple[float, float] | None:
        """The largest tolerance of the defect that keeps the errors, and the mean step (s) with it."""
        found = []
        interval = self._surveyor.sampled.interval
        for step in self._method.errors:
            factor = round(step / interval)
            defects = self._measure_defects(factor)
            for relative in TOLERANCES:
                lengths = self._predict_lengths(defects, relative, longest / step)
                weights = lengths**self._behaviour.order
                if self._surveyor.predict_excess(self._behaviour, factor, weights) <= 1.0 / WITHIN:
                    mean = float(1.0 / np.mean(1.0 / lengths))
                    found.append((abs(math.log(mean)), relative, mean * step))
                    break
        return min(found)[1:] if found else None

    def _measure_defects(self, factor: int) -> Vector:
        """The defect at the end of each of the trajectory's steps, over what a tolerance of one allows."""
        sampled = self._surveyor.sampled
        missed = np.abs(sampled.compute_extrapolation_errors(factor, self._behaviour.single.degrees)[:, 1])
        sizes = self._behaviour.single.nominal + np.abs(sampled.values[::factor])
        parts = (missed / sizes)[:, self._columns]
        rms = np.sqrt(np.sum(parts**2, axis=1) / max(1, self._count))
        return np.asarray(maximum_filter1d(rms, REMEMBERED))

    def _predict_lengths(self, defects: Vector, relative: float, longest: float) -> Vector:
        """The steps that are made, over the one of the defects."""
        allowed = (AIM * relative / np.maximum(defects, 1e-300)) ** (1.0 / self._behaviour.order)
        return np.minimum(KEPT * allowed, longest)


def _apply(found: Survey, choice: Choice) -> Scenario:
    """The scenario with the choice in its tables."""
    scenario, master = found.scenario, choice.method.master
    options = {"order": list(master.order), "iterate": list(master.iterate)}
    table = MasterTable(
        name=find_name(master),
        extrapolation=master.extrapolation,
        chosen=describe(found, choice),
        **{key: names for key, names in options.items() if names},
    )
    control = None
    if choice.relative is not None:
        control = StepControlTable(
            estimator="defect", relative=float(f"{choice.relative:.2g}"), maximum_step=choice.step
        )
    changes = {"master": table, "step_control": control, "macro_step": choice.step}
    # What a longer macro step makes void.
    if (scenario.output_step or math.inf) < choice.step:
        changes["output_step"] = None
    if (scenario.event_tolerance or 0.0) >= choice.step:
        changes["event_tolerance"] = None
    return scenario.model_copy(update=changes)


def describe(found: Survey, choice: Choice) -> str:
    """The choice and its reason, in a sentence."""
    method = choice.method
    steps = f"equal steps of {format_time(choice.step)}"
    if choice.relative is not None:
        steps = f"steps up to {format_time(choice.step)} that keep {choice.relative:.1e} for their defect"
    limit = "every step that was tried is stable"
    if math.isfinite(method.limit):
        where = f" ({method.growing_output} runs away beyond)" if method.growing_output else ""
        limit = f"it is stable up to {format_time(method.limit)}{where}"
    return (
        f"auto chose {method.name} with {steps}: {limit}; equal steps keep the tolerance up to "
        f"{format_time(method.accurate_step)}; {choice.cost:.2g} participant steps are predicted"
    )
