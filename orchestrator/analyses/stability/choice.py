"""`[master] name = "auto"`: the master, signals and macro steps that keep the tolerance at the least cost.

The survey of the coupling gives, for each method, the largest stable step and the errors of equal steps.
Steps that follow their defect are predicted from the same errors: with steps H instead of equal steps h they
are (H/h)^p times as large, p being the order of the signals. Where the equations are known the cheapest is
tried in this process against the motion. After a hard landing errors depend on its instant, which nothing
predicts: there steps that follow their error are tried only, and equal steps.
"""

from __future__ import annotations

import math
from bisect import bisect_left
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from scipy.ndimage import maximum_filter1d

from models.core.quantities import Vector
from models.core.system import ModelError, System
from models.monolithic.trajectory import Trajectory

from ...assessment.contacts import summarise_rows
from ...engine.signals import DEGREES
from ...errors import MistakeError, RefusedError, RunError, Set, UnstableCouplingError
from ...masters import GaussSeidel, Iterated, Master, find_name
from ...reporter import CHOICE, Reporter
from ...scenario import Scenario, ScenarioError
from ...scenario.capabilities import list_foreign
from ...scenario.fmu_limits import FmuLimits
from ...scenario.master_table import AUTO, MasterTable, StepControlTable
from ...scenario.scenario import COMPARED_INTERVALS
from ...scenario.system import Resolved
from ...scenario.units import format_time
from ...stepping import DEFECT
from ...stepping.controlled import AIM
from ...stepping.forward import find_extrapolated
from .analyse import survey_scenario
from .behaviour import Behaviour
from .survey import DOWN, WITHIN, AssessedMethod, Scope, Survey
from .trajectory import solve_course
from .trial import TOO_MANY, Outcome, Trial

# Safety factor towards the stability limit: steps that follow their defect become shorter where values swing.
MARGIN = 1.25
# The steps that are made, over those that the error aimed at allows: a step is kept until twice as long a one
# is allowed, and an error is remembered for some steps.
KEPT, REMEMBERED = 0.8, 7
# Steps of a run at least. Without a loop, which could become unstable, only the course of the values limits
# them: twice as many then, as the run's guard takes values that jump in each step for an instability.
LEAST = COMPARED_INTERVALS
# Share of a contact's largest load: with landings of 0.95 and more predicted runs missed the tolerance, 5 to
# 94 times; with one of 0.15 a run kept it.
HARD = 0.25
# Tolerances of the defect that are tried.
TOLERANCES = tuple(10.0 ** (-0.25 * k) for k in range(4, 33))
# Tolerance of the motion that trials are compared with where there are impacts, over which errors grow.
EXACT = 1e-11
# Signals that are weighed: held values are never the least work.
SIGNALS = tuple(DEGREES)[1:]
# Steps are scanned for stability by this share: a trial follows, which sees what lies between them.
SHARE = 0.1
# Predicted choices that are tried; the factor by which an error that cannot be measured counts as too large.
TRIALS, LOST = 6, 8.0
# Methods that are tried without a prediction, and tolerances of a step, the loosest first.
CONTROLLED = (
    (GaussSeidel(extrapolation="hermite"), "step_doubling"),
    (Iterated(extrapolation="hermite"), "predictor_corrector"),
    (GaussSeidel(extrapolation="hermite"), DEFECT),
)
# Tolerance of an iteration with equal steps, over the least that is allowed: its errors add up over the run.
ITERATED = 0.01
STEP_TOLERANCES = tuple(10.0 ** (-0.5 * k) for k in range(4, 15))


@dataclass(frozen=True)
class Choice:
    """A master with equal steps (s), or with steps up to that length that keep `relative` by `estimator`.

    `order` is that of the error, `cost` the participant steps of the whole run, as predicted or tried; `why`
    is its reason. Runs with `tried` participant steps were made to find it."""

    master: Master
    step: float
    cost: float
    why: str
    order: int
    relative: float = 0.0
    estimator: str | None = None
    tried: int = 0

    def shorten(self, excess: float) -> Choice:
        """The same in shorter steps, after an error of `excess` times what is allowed."""
        factor = 1.0 / WITHIN / (excess if math.isfinite(excess) else LOST)
        if self.relative:
            step, relative = self.step, factor * self.relative
        else:
            step, relative = self.step * factor ** (1.0 / self.order), 0.0
        cost = self.cost / factor ** (1.0 / self.order)
        return replace(self, step=step, relative=relative, cost=cost)


def choose(resolved: Resolved, reporter: Reporter) -> Resolved:
    """The scenario with what `auto` chooses for it.

    ScenarioError, which says why, if nothing can be chosen.
    """
    try:
        chosen = apply(resolved.scenario, find_choice(resolved, reporter))
    except RefusedError:  # by a participant, whatever the master
        raise
    except UnstableCouplingError as error:
        halved, *_ = error.remedies  # others name `auto`, or masters
        said = f"master.name = {AUTO!r}: ", error.fault, "; ", halved, ", or name a master"
        raise ScenarioError(said) from None
    except (MistakeError, ModelError, RunError) as error:
        remedy = "; name a master, e.g. ", Set("master.name", "gauss_seidel")
        raise ScenarioError((f"master.name = {AUTO!r}: ", error, remedy)) from None
    return resolved.with_master_of(chosen)


def find_choice(resolved: Resolved, reporter: Reporter) -> Choice:
    """What `auto` chooses; MistakeError, ModelError or RunError, which says why, if nothing can be chosen."""
    scenario = resolved.scenario
    known, why = not list_foreign(scenario), "no predicted choice keeps the tolerance in reasonable steps"
    iterated = Iterated(tolerance=ITERATED * min(scenario.tolerance.values(), default=1.0))
    scope = Scope((GaussSeidel(), iterated), SIGNALS, scenario.stop_time / LEAST, SHARE, refuse_impacts)
    try:
        found = survey_scenario(resolved, [], reporter, scope)
    except HardLandingError as landing:
        best, why, tries = None, str(landing), _Tries(resolved, landing.motion)
    else:
        choices, tries = list(list_choices(found)), _Tries(resolved, found.motion)
        best = tries.choose_predicted(choices, TRIALS if known else 0)
    if best is None and known:
        with reporter.stage(CHOICE):
            best = tries.choose_tried(why)
    if best is None:
        raise MistakeError("no master is stable and within the tolerance at any step tried")
    return replace(best, tried=tries.taken)


def _rank(choice: Choice) -> tuple[float, int]:
    """The cheapest first; of equals the one with the best guess."""
    return choice.cost, -choice.master.degree


class _Tries:
    """Chooses by runs of the equations in this process."""

    def __init__(self, resolved: Resolved, motion: Trajectory) -> None:
        self._scenario, system = resolved.scenario, resolved.system
        if any(instance.component.events for instance in system.instances.values()):
            motion = solve_course(system, motion.times, EXACT, lambda share: None)
        names = system.outputs.names
        columns = [names.index(name) for name in self._scenario.tolerance]
        self._trial = Trial(resolved, motion.times, motion.outputs[:, columns])
        self.taken = 0  # participant steps
        # No more than in the shortest steps that are surveyed.
        count = DOWN * self._scenario.stop_time / self._scenario.macro_step
        self._most = count * len(self._scenario.components)

    def choose_predicted(self, choices: list[Choice], trials: int) -> Choice | None:
        """The cheapest that keeps the tolerance in a trial; after one that misses it, it is shortened.

        Without trials the cheapest. None if it takes more steps than can be surveyed."""
        for _ in range(trials):
            best = min(choices, key=_rank, default=None)
            if best is None or best.cost > self._most:
                return None
            if (made := self._run(best)).good:
                return best
            choices[choices.index(best)] = best.shorten(made.error)
        return None if trials else min(choices, key=_rank, default=None)

    def choose_tried(self, why: str) -> Choice | None:
        """The cheapest of what no prediction is needed for."""
        best: Choice | None = None
        for ladder in self._list_ladders(why):
            loosest, end = 0, len(ladder)
            while loosest < end:
                middle = (loosest + end) // 2
                made = self._run(ladder[middle], best.cost if best else self._most)
                if made.good:
                    best = replace(ladder[middle], cost=made.steps)
                if made.good or made.note == TOO_MANY:
                    end = middle
                else:
                    loosest = middle + 1
        return best

    def _list_ladders(self, why: str) -> Iterator[list[Choice]]:
        """Choices, the loosest first: steps that follow their error; equal steps.

        These end at instants of the motion: where it jumps, others can't be judged to a small tolerance."""
        macro, stop = self._scenario.macro_step, self._scenario.stop_time
        for master, estimator in CONTROLLED if FmuLimits(self._scenario).controllable else ():
            step = stop / LEAST if estimator == DEFECT else macro
            yield [Choice(master, step, math.inf, why, 4, one, estimator) for one in STEP_TOLERANCES]
        longest = math.floor(math.log2(stop / macro / (2 * LEAST)))
        steps = [macro * 2.0**power for power in range(longest, -2, -1)]
        yield [Choice(GaussSeidel(extrapolation="hermite"), step, math.inf, why, 4) for step in steps]

    def _run(self, choice: Choice, most: float = math.inf) -> Outcome:
        chosen = apply(self._scenario, choice)
        made = self._trial.run("", chosen.build_master(), chosen.build_steps(), most)
        self.taken += made.steps
        return made


class HardLandingError(MistakeError):
    """A contact lands hard: the errors that follow depend on the instant of the landing."""

    def __init__(self, said: str, motion: Trajectory) -> None:
        super().__init__(said)
        self.motion = motion


def refuse_impacts(system: System, motion: Trajectory) -> None:
    """HardLandingError if a contact lands hard in the motion."""

    def column(name: str) -> Vector:
        return motion.times if name == "time" else motion.outputs[:, system.outputs.names.index(name)]

    for name, contact in summarise_rows(system, column).items():
        impact = contact.impact
        if impact and impact.load >= HARD * contact.largest_load:
            said = (
                f"{name} lands at t = {impact.time:.3g} s with {impact.load:.3g} N, "
                f"{100.0 * impact.load / contact.largest_load:.0f} % of its largest load"
            )
            raise HardLandingError(said, motion)


def list_choices(found: Survey) -> Iterator[Choice]:
    """The methods with equal steps, and the explicit ones with steps that follow their defect."""
    scenario = found.scenario
    longest = scenario.stop_time / (LEAST if found.partition.loops else 2 * LEAST)
    for method in found.methods:
        stable = min(method.limit / MARGIN, longest)
        step = min(method.safe_step, stable)
        if not (step > 0.0 and math.isfinite(method.cost)):
            continue
        count = math.ceil(scenario.stop_time / step * (1.0 - 1e-9))
        per_step = method.cost * method.advised_step
        why, order = _explain(method), found.behave(method.master).order
        equal = Choice(method.master, scenario.stop_time / count, count * per_step, why, order)
        yield equal
        if not method.master.implicit and found.limits.variable_step and found.system.connections:
            control = _Defect(found, method).find_tolerance(stable)
            if control is not None:
                relative, mean = control
                cost = scenario.stop_time / mean * per_step
                yield replace(equal, step=stable, cost=cost, relative=relative, estimator=DEFECT)


def _explain(method: AssessedMethod) -> str:
    limit = "every step that was tried is stable"
    if math.isfinite(method.limit):
        where = f" ({method.growing_output} runs away beyond)" if method.growing_output else ""
        limit = f"it is stable up to {format_time(method.limit)}{where}"
    return f"{limit}; equal steps keep the tolerance up to {format_time(method.accurate_step)}"


class _Defect:
    """Predicts a method's run with steps that follow their defect."""

    def __init__(self, found: Survey, method: AssessedMethod) -> None:
        self._survey, self._method = found, method
        self._behaviour: Behaviour = found.behave(method.master)
        coupling = self._behaviour.single.coupling
        extrapolated = find_extrapolated(coupling, method.master)
        self._seen = np.flatnonzero(extrapolated[coupling.wiring.connected])
        self._columns = coupling.wiring.connected[self._seen]
        self._count = len(coupling.wiring.connected)

    def find_tolerance(self, longest: float) -> tuple[float, float] | None:
        """The largest tolerance of the defect that keeps the errors, and the mean step (s) with it."""
        found = [self._find_tolerance(step, longest / step) for step in self._method.errors]
        return min(filter(None, found))[1:] if any(found) else None

    def _find_tolerance(self, step: float, longest: float) -> tuple[float, float, float] | None:
        """From errors at one step: how far the mean step is from it; the tolerance; the mean step (s)."""
        factor = round(step / self._survey.sampled.interval)
        course, defects = self._survey.follow_errors(self._behaviour, factor), self._measure_defects(factor)

        def keeps(relative: float) -> bool:
            weights = self._predict_lengths(defects, relative, longest) ** self._behaviour.order
            return self._survey.predict_excess(course, weights) <= 1.0 / WITHIN

        first = bisect_left(TOLERANCES, True, key=keeps)
        if first == len(TOLERANCES):
            return None
        mean = float(1.0 / np.mean(1.0 / self._predict_lengths(defects, TOLERANCES[first], longest)))
        return abs(math.log(mean)), TOLERANCES[first], mean * step

    def _measure_defects(self, factor: int) -> Vector:
        """The defect at the end of each of the trajectory's steps, over what a tolerance of one allows."""
        sampled = self._survey.sampled
        missed = np.abs(sampled.compute_extrapolation_errors(factor, self._behaviour.single.degrees)[:, 1])
        sizes = self._behaviour.single.nominal + np.abs(sampled.values[::factor])
        parts = (missed / sizes)[:, self._columns]
        rms = np.sqrt(np.sum(parts**2, axis=1) / max(1, self._count))
        return np.asarray(maximum_filter1d(rms, REMEMBERED))

    def _predict_lengths(self, defects: Vector, relative: float, longest: float) -> Vector:
        """The steps that are made, over the one of the defects."""
        allowed = (AIM * relative / np.maximum(defects, 1e-300)) ** (1.0 / self._behaviour.order)
        return np.minimum(KEPT * allowed, longest)


def apply(scenario: Scenario, choice: Choice) -> Scenario:
    """The scenario with the choice in its tables."""
    master: Any = choice.master
    control, step = None, choice.step
    options: dict[str, Any] = {"order": list(master.order), "iterate": list(master.iterate)}
    if master.implicit and choice.estimator is None:
        options["tolerance"] = master.tolerance
    table = MasterTable(
        name=find_name(master),
        extrapolation=master.extrapolation,
        chosen=describe(choice),
        **{key: value for key, value in options.items() if value},
    )
    if choice.estimator is not None:
        longest = choice.step if choice.estimator == DEFECT else scenario.stop_time / LEAST
        step = min(step, longest)
        control = StepControlTable(
            estimator=choice.estimator, relative=float(f"{choice.relative:.2g}"), maximum_step=longest
        )
    changes = {"master": table, "step_control": control, "macro_step": step}
    # What the macro step, or steps of many lengths, make void.
    if scenario.output_step:
        every = 0 if control else round(scenario.output_step / step)
        changes["output_step"] = every * step if every else None
    if (scenario.event_tolerance or 0.0) >= step:
        changes["event_tolerance"] = None
    return scenario.model_copy(update=changes)


def describe(choice: Choice) -> str:
    """The choice and its reason, in a sentence."""
    steps = f"equal steps of {format_time(choice.step)}"
    counted = f"; {choice.cost:.2g} participant steps are predicted" if math.isfinite(choice.cost) else ""
    counted += f", {choice.tried:.2g} were tried" if choice.tried else ""
    if choice.estimator == DEFECT:
        steps = f"steps up to {format_time(choice.step)} that keep {choice.relative:.1e} for their defect"
    elif choice.estimator:
        steps = f"steps that are made again unless they keep {choice.relative:.1e} by {choice.estimator}"
    name = f"{find_name(choice.master)} {choice.master.extrapolation}"
    return f"auto chose {name} with {steps}: {choice.why}{counted}"
