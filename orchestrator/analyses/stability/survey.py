"""The survey of a scenario: every master with every signal, and the advised one."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, fields, replace
from typing import Any

import numpy as np

from models.core.quantities import Vector
from models.core.system import Port, System, parse_port
from models.monolithic.trajectory import Trajectory

from ...engine.signals import DEGREES
from ...masters import MASTERS, Master, find_name
from ...run.plan import ParticipantPlan, open_participants
from ...scenario import Scenario, ScenarioError
from ...scenario.capabilities import list_foreign
from ...scenario.fmu_limits import FmuLimits
from .behaviour import SHARE, Behaviour, Couplings, StepBehaviour, find_hardest_point, find_stability_limit
from .linearisation import POINTS, Point, linearise_points
from .macro_step import ErrorCourse, SampledTrajectory, follow_errors, sample_trajectory
from .partition import Partition
from .trajectory import STRIDE, ParticipantLinearisation, run_course, solve_course


@dataclass
class AssessedMethod:
    """Findings about a master with its signal. Steps in s; errors as in the scenario's tolerance."""

    master: Master
    samples: list[StepBehaviour] = field(default_factory=list)
    limit: float = math.inf
    hardest_time: float = 0.0
    growing_output: Port | None = None
    errors: dict[float, dict[str, float]] = field(default_factory=dict)
    accurate_step: float = 0.0
    safe_step: float = 0.0
    advised_step: float = 0.0
    cost: float = math.inf

    @property
    def name(self) -> str:
        return f"{find_name(self.master)} {self.master.extrapolation}"

    @property
    def order(self) -> tuple[str, ...]:
        """The order of participants; empty if it makes no difference."""
        return self.master.order

    @property
    def contracting_step(self) -> float:
        """The largest sampled step up to which a plain iteration contracts; NaN for explicit masters."""
        if not self.master.implicit:
            return math.nan
        good = 0.0
        for at in self.samples:
            if not at.contraction < 1.0:
                break
            good = at.step
        return good


# Trajectory: instants per macro step, most instants, and the integrator's tolerance; differences of fourth
# order amplify its error by sixteen.
FINER, INSTANTS, COURSE_TOLERANCE = 2, 60_000, 1e-9
# The range of steps: from the scenario's step over DOWN to the scenario's step times UP.
DOWN, UP = 8.0, 256.0
# Safety factors of the advised step, towards the stability limit (because of nonlinearity) and towards the
# tolerance (because errors are estimates).
AWAY, WITHIN = 1.5, 2.0
# A point is harder if it is unstable at this share of the limit found so far.
ALMOST = 0.97
# Orders are compared at steps longer by this factor.
LONGER = 1.05


@dataclass(frozen=True)
class Scope:
    """The masters that are assessed with these signals and every order, up to the `longest` step (s).

    They are scanned by `share` of the step. `check` looks at the solved motion before and raises an error
    where nothing shall be assessed."""

    masters: Sequence[Master] = tuple(kind() for kind in MASTERS.values())
    signals: Sequence[str] = tuple(DEGREES)
    longest: float = math.inf
    share: float = SHARE
    check: Callable[[System, Trajectory], None] = lambda system, motion: None


EVERY = Scope()


def survey(
    scenario: Scenario,
    system: System,
    plans: Mapping[str, ParticipantPlan],
    participants: Mapping[str, ParticipantLinearisation],
    at: Sequence[float] = (),
    progress: Callable[[float], None] = lambda share: None,
    scope: Scope = EVERY,
) -> Survey:
    """Survey the methods on the scenario's system, which has its start values; ModelError if it fails.

    What is not in `participants` is linearised by its equations. `at` are further instants (s) at which to
    linearise. The scenario's own master is assessed beside those in `scope`.
    """
    watched = [parse_port(n, system.instances, "output") for n in scenario.tolerance]
    limits = FmuLimits(scenario)
    interval = scenario.macro_step / FINER
    count = min(INSTANTS, round(scenario.stop_time / interval))
    trajectory = _find_course(
        scenario, system, plans, np.arange(count + 1) * np.float64(interval), lambda s: progress(0.2 * s)
    )
    scope.check(system, trajectory)
    rows = np.linspace(0, count, POINTS, endpoint=False).astype(int)
    rows = np.unique([*rows, *(round(min(max(t / interval, 0.0), count)) for t in at)])
    if not limits.variable_step:  # which gets to whole strides only
        rows = np.unique(rows // STRIDE * STRIDE)
    points, left = linearise_points(system, trajectory, rows.tolist(), watched, participants)
    found = Survey(scenario, system, trajectory, watched, points, scope)
    found.limits, found.participants, found.left_out = limits, participants, left
    masters = found.list_masters(scope)
    for i, master in enumerate(masters):
        found.methods.append(found.assess(master))
        progress(0.3 + 0.7 * (i + 1) / len(masters))
    found.own = found.methods[0]
    found.methods.sort(key=lambda m: m.cost)
    usable = (m for m in found.methods if limits.restorable or not m.master.implicit)
    found.best = next((m for m in usable if m.advised_step > 0.0), None)
    return found


def check_comparable(scenario: Scenario) -> None:
    """ScenarioError for one whose methods no predicted error compares."""
    if not scenario.tolerance:
        raise ScenarioError(
            "tolerance: missing; state the error allowed of an output, by which methods are compared"
        )
    if stepwise := FmuLimits(scenario).stepwise:
        names = ", ".join(map(str, dict.fromkeys(stepwise)))
        raise ScenarioError(
            f"{names}: declared discrete, so held over each macro step; the error of such a signal cannot be "
            "predicted"
        )


def _find_course(
    scenario: Scenario,
    system: System,
    plans: Mapping[str, ParticipantPlan],
    times: Vector,
    progress: Callable[[float], None],
) -> Trajectory:
    """The motion: solved, or where that is not possible run as the scenario is, in shorter steps."""
    if not list_foreign(scenario):
        return solve_course(system, times, COURSE_TOLERANCE, progress)
    with open_participants(system, plans) as units:
        return run_course(system, units, scenario.master.build(), times, progress)


class Survey:
    """A scenario's methods, cheapest first; `own` is the scenario's, `best` the advised one, if any.

    Errors are predicted along the `motion`, about the `typical` point. `participants` were linearised as
    participants, the others as components; `left_out` says why instants were left out. `limits` are those of
    the FMU files.
    """

    own: AssessedMethod
    best: AssessedMethod | None
    limits: FmuLimits
    participants: Mapping[str, ParticipantLinearisation]
    left_out: list[str]

    def __init__(
        self, scenario: Scenario, system: System, trajectory: Trajectory, watched: list[Port],
        points: list[Point], scope: Scope,
    ) -> None:  # fmt: skip
        self.scenario, self.system, self.points, self.motion = scenario, system, points, trajectory
        self.methods: list[AssessedMethod] = []
        self._converged: dict[tuple[Any, ...], AssessedMethod] = {}
        self.partition = Partition(system, points, watched)
        names = {n: [port.variable for port in watched if port.instance == n] for n in system.instances}
        self._couplings = Couplings(system, names)
        hermite = MASTERS["jacobi"](extrapolation="hermite")
        # The highest degree of a signal that participants follow.
        self.highest = max(self._couplings.get(point, hermite, 1).highest for point in points)
        self._first = scenario.macro_step / DOWN
        self._longest = min(
            UP * scenario.macro_step, scenario.stop_time, max(scope.longest, scenario.macro_step)
        )
        self._share = scope.share
        probe = MASTERS["jacobi"]()
        self.hardest_point, _ = find_hardest_point(
            points, probe, self._first, self._longest, self._couplings, self._share
        )
        sources = Behaviour(points[0], probe, self._couplings).sources
        self.sampled: SampledTrajectory = sample_trajectory(trajectory, system, sources)
        self._names = {str(port): sources.index(port) for port in watched}
        self.typical = self._find_typical_point()

    @property
    def kinks(self) -> list[str]:
        """Variables that had a kink at a point."""
        return list(dict.fromkeys(kink for point in self.points for kink in point.kinks))

    def list_masters(self, scope: Scope) -> list[Master]:
        """The scenario's own master, then those of the scope that its FMUs can take, in the best order."""
        own = self.scenario.master.build()
        signals = [one for one in scope.signals if DEGREES[one] <= self.highest]
        orders, stiff = {signal: self.find_order(signal) for signal in signals}, self.partition.stiff
        unset = any(item.name == "order" for item in fields(own)) and not own.order
        if unset and orders.get(own.extrapolation) == tuple(self.system.instances):
            own = replace(own, order=orders[own.extrapolation])
        masters: list[Master] = [own]
        # Other options are those of the scenario's master.
        for base in dict.fromkeys(
            [own if isinstance(own, type(one)) else one for one in scope.masters] + [own]
        ):
            options = {item.name for item in fields(base)}
            if "extrapolation" not in options or (base.implicit and not self.limits.restorable):
                continue
            if "iterate" in options and not base.iterate and stiff:
                base = replace(base, iterate=stiff)
            for signal, order in orders.items():
                ordered = {"order": order} if "order" in options else {}
                masters.append(replace(base, extrapolation=signal, **ordered))
        return list(dict.fromkeys(masters))

    def _find_typical_point(self) -> Point:
        """The point about which errors are predicted: that of median errors.

        If events can change a participant, it is that of the largest errors. A kink at a point makes slopes
        that hold for an instant only, so it is none of these unless all are.
        """
        kind = MASTERS["gauss_seidel"]
        excess = []
        points = [point for point in self.points if not point.kinks] or self.points
        for point in points:
            behaviour = Behaviour(point, kind(), self._couplings)
            excess.append(self.predict_excess(self.follow_errors(behaviour, FINER)))
        events = any(i.component.events for i in self.system.instances.values())
        return points[int(np.argsort(excess)[-1 if events else len(excess) // 2])]

    def find_order(self, signal: str) -> tuple[str, ...]:
        """The Gauss-Seidel order that is stable up to the longest step; of several the most accurate."""

        def build(point: Point, order: tuple[str, ...] = ()) -> Behaviour:
            master = MASTERS["gauss_seidel"](extrapolation=signal, order=order)
            return Behaviour(point, master, self._couplings)

        orders = list(self.partition.list_orders())
        if len(orders) == 1:
            return orders[0]
        found = {order: build(self.hardest_point, order) for order in orders}
        limit = self._find_stability_limit(build(self.hardest_point), self._longest)
        step, equal = min(max(ALMOST * limit, self._first), self._longest), orders
        while stable := [order for order in equal if found[order].evaluate(step).stable]:
            equal = stable
            if len(equal) == 1 or step == self._longest:
                break
            step = min(LONGER * step, self._longest)
        if len(equal) == 1 or not limit > self.scenario.macro_step:
            return equal[0]
        errors = {o: self._predict_errors(self.follow_errors(build(self.typical, o), FINER)) for o in equal}
        return min(equal, key=lambda order: max(errors[order].values()))

    def assess(self, master: Master) -> AssessedMethod:
        """Assess a master. Implicit masters converge to the same step, so only their costs differ."""
        key = (master.degree, master.order, master.iterate)
        if master.implicit and key in self._converged:
            found = replace(self._converged[key], master=master)
        else:
            found = self._find_limit(master)
            self._predict_steps(found)
            if master.implicit and all(math.isfinite(at.radius) for at in found.samples):
                self._converged[key] = replace(found)
        self._estimate_cost(found)
        return found

    def _find_limit(self, master: Master) -> AssessedMethod:
        found = AssessedMethod(master)
        worst = Behaviour(self.hardest_point, master, self._couplings)
        found.limit = find_stability_limit(worst, self._first, self._longest, found.samples, self._share)
        found.hardest_time = self.hardest_point.time
        for point in self.points:
            other = Behaviour(point, master, self._couplings)
            just = min(ALMOST * found.limit, self._longest)
            if found.limit > 0.0 and not other.evaluate(just).stable:
                found.limit = min(found.limit, self._find_stability_limit(other, just))
                worst, found.hardest_time = other, point.time
        if 0.0 < found.limit < math.inf:
            found.growing_output = worst.find_growing_output(1.1 * found.limit)
        return found

    def _find_stability_limit(self, behaviour: Behaviour, longest: float) -> float:
        return find_stability_limit(behaviour, self._first, longest, [], self._share)

    def behave(self, master: Master) -> Behaviour:
        """A master about the typical point."""
        return Behaviour(self.typical, master, self._couplings)

    def follow_errors(self, behaviour: Behaviour, factor: int) -> ErrorCourse | None:
        """The errors of macro steps of `factor` intervals; None if the iteration does not converge."""
        operator = behaviour.macro_step(factor * self.sampled.interval)
        if operator is None:
            return None
        defect = behaviour.find_defect(operator.step)
        return follow_errors(operator, defect, self.sampled, factor, behaviour.single.nominal)

    def _predict_errors(self, course: ErrorCourse | None, weights: Vector | float = 1.0) -> dict[str, float]:
        """Predicted errors; `weights` multiply what each step adds."""
        if course is None:
            return dict.fromkeys(self._names, math.inf)
        found = course.predict(weights)
        return {name: float(found[i]) for name, i in self._names.items()}

    def predict_excess(self, course: ErrorCourse | None, weights: Vector | float = 1.0) -> float:
        """The largest predicted error over its tolerance."""
        return self._compute_excess(self._predict_errors(course, weights))

    def _predict_steps(self, found: AssessedMethod) -> None:
        """Predict errors over the step, and the largest steps that stability and tolerance allow."""
        step, interval = self.scenario.macro_step, self.sampled.interval
        factor, behaviour = FINER, self.behave(found.master)
        while factor * interval < found.limit and len(self.sampled.values) > 8 * factor:
            # The scan of the hardest point does not show islands of instability of this one.
            if not behaviour.evaluate(factor * interval).stable:
                found.limit = self._find_stability_limit(behaviour, factor * interval)
                found.growing_output, found.hardest_time = (
                    behaviour.find_growing_output(factor * interval),
                    self.typical.time,
                )
                break
            errors = self._predict_errors(self.follow_errors(behaviour, factor))
            found.errors[factor * interval] = errors
            if factor * interval >= self._longest or self._compute_excess(errors) > 100.0:
                break
            factor *= 2
        if interval < found.limit and self._compute_excess(found.errors.get(step, {})) > 1.0:
            found.errors[interval] = self._predict_errors(self.follow_errors(behaviour, 1))
        found.errors = dict(sorted(found.errors.items()))
        excess = {at: self._compute_excess(errors) for at, errors in found.errors.items()}
        found.accurate_step = find_step_at_error(excess, behaviour.order, 1.0)
        found.safe_step = find_step_at_error(excess, behaviour.order, 1.0 / WITHIN)
        found.advised_step = round_down(min(found.safe_step, found.limit / AWAY, self._longest))

    def _estimate_cost(self, found: AssessedMethod) -> None:
        """Estimate the cost of the advised step; withdraw it if the master's iteration fails there."""
        if not found.advised_step > 0.0:
            return
        interval = self.sampled.interval
        factor = max(1, round(found.advised_step / interval))
        behaviour = self.behave(found.master)
        per_step = self.sampled.compute_extrapolation_errors(factor, behaviour.single.degrees)
        amounts = (np.sqrt(np.mean(per_step**2, axis=0)) / behaviour.single.nominal).ravel()
        found.cost = behaviour.count_participant_steps(found.advised_step, amounts) / found.advised_step
        if not math.isfinite(found.cost):
            found.advised_step = 0.0

    def _compute_excess(self, errors: Mapping[str, float]) -> float:
        """The largest error over its tolerance."""
        return max(
            (error / self.scenario.tolerance[name] for name, error in errors.items()), default=math.inf
        )


# Mantissas of advised steps.
ROUND = (1.0, 1.2, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 6.0, 8.0)


def find_step_at_error(excess: Mapping[float, float], order: int, share: float) -> float:
    """Find the step at which the excess grows beyond `share`, by a power law between known steps.

    Below the first one the power is the method's order.
    """
    steps = list(excess)
    if not steps or not math.isfinite(excess[steps[0]]):
        return 0.0
    if excess[steps[0]] > share:
        return float(steps[0] * (share / excess[steps[0]]) ** (1.0 / order))
    for low, high in itertools.pairwise(steps):
        if not excess[high] <= share:
            if not math.isfinite(excess[high]) or excess[low] <= 0.0:
                return low
            slope = math.log(high / low) / math.log(excess[high] / excess[low])
            return float(low * (share / excess[low]) ** slope)
    return steps[-1]


def round_down(step: float) -> float:
    """Round down to a step with a short mantissa; zero for zero."""
    if not step > 0.0:
        return 0.0
    power = 10.0 ** math.floor(math.log10(step))
    return float(f"{max(m for m in ROUND if m * power <= step * (1.0 + 1e-12)) * power:.3g}")
