"""The survey of a scenario: every master with every signal, and what is to be recommended."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import fields, replace
from typing import Any

import numpy as np

from models.core.system import Port, System, parse_port
from models.monolithic.trajectory import Course

from ..engine.signals import DEGREES
from ..masters import MASTERS, Master
from ..scenario import Scenario
from ..scenario.fmu_limits import FmuLimits
from .behaviour import Behaviour, Benches, hardest, largest_stable
from .course import course_of
from .error import Sampled, predicted, sampled
from .extrapolation_error import HERMITE
from .findings import Survey, Surveyed
from .linearisation import Linearisation
from .partition import Partition
from .points import Point, points_at
from .sources import as_participants
from .steps import reached, rounded_down

# Of the course: instants for each macro step, most instants, and the integrator's tolerance. The highest
# differences taken of it, of fourth order, add up sixteen times its error.
FINER, INSTANTS, COURSE_TOLERANCE = 2, 60_000, 1e-9
# Instants of the course at which the system is linearised.
POINTS = 12
# Steps are looked at from the scenario's over this to the scenario's times that.
DOWN, UP = 8.0, 256.0
# What is recommended keeps away from the end of stability and of the tolerance by these factors: the first
# for what is not linear, the second for an estimate's.
AWAY, WITHIN = 1.5, 2.0
# Another point is harder if it is unstable at this share of the limit found so far.
ALMOST = 0.97


def survey(
    scenario: Scenario,
    system: System,
    at: Sequence[float] = (),
    progress: Callable[[float], None] = lambda share: None,
    made: Mapping[str, Linearisation] | None = None,
) -> Survey:
    """Survey the methods on the scenario's system, which has its start values; ModelError if it fails.

    `at` are further instants of the course (s) at which to linearise; `made` linearises the participants (by
    their equations).
    """
    step, watched = (
        scenario.macro_step,
        [parse_port(n, system.instances, "output") for n in scenario.tolerance],
    )
    interval = step / FINER
    count = min(INSTANTS, round(scenario.stop_time / interval))
    where = course_of(
        system, np.arange(count + 1) * np.float64(interval), COURSE_TOLERANCE, lambda s: progress(0.2 * s)
    )
    rows = np.linspace(0, count, POINTS, endpoint=False).astype(int)
    rows = np.unique([*rows, *(round(min(max(t / interval, 0.0), count)) for t in at)])
    points, left = points_at(system, where, rows.tolist(), watched, made)
    surveyor = _Surveyor(scenario, system, where, watched, points)
    methods = []
    kinds = _methods(scenario, system, surveyor)
    for i, master in enumerate(kinds):
        methods.append(surveyor.method(master))
        progress(0.3 + 0.7 * (i + 1) / len(kinds))
    own = methods[0]
    restorable = FmuLimits(scenario).restorable
    usable = [m for m in methods if m.recommended > 0.0 and (restorable or not m.master.implicit)]
    methods.sort(key=lambda m: m.cost)
    return Survey(
        scenario, system, surveyor.partition, surveyor.points, methods, own,
        min(usable, key=lambda m: m.cost, default=None), float(where.times[-1]), surveyor.typical.time,
        as_participants(made or {}), left,
    )  # fmt: skip


def _methods(scenario: Scenario, system: System, surveyor: _Surveyor) -> list[Master]:
    """The scenario's own master, then every master with every signal, in the best order."""
    own = scenario.master.build()
    order, stiff = surveyor.order(), surveyor.partition.stiff
    if getattr(own, "order", None) == () and order == tuple(system.instances):
        own = replace(own, order=order)
    made: list[Master] = [own]
    for kind in MASTERS.values():
        options = {item.name for item in fields(kind)}
        if "extrapolation" not in options:
            continue
        # Options of the scenario's master that are not compared here stay as they are.
        base: Any = own if isinstance(own, kind) else kind()
        if "iterate" in options and not base.iterate and stiff:
            base = replace(base, iterate=stiff)
        for signal in list(DEGREES)[: surveyor.highest + 1]:
            ordered = {"order": order} if "order" in options else {}
            made.append(replace(base, extrapolation=signal, **ordered))
    return list(dict.fromkeys(made))


class _Surveyor:
    def __init__(
        self, scenario: Scenario, system: System, where: Course, watched: list[Port], points: list[Point]
    ) -> None:
        self.scenario, self.system, self.points = scenario, system, points
        self._converged: dict[tuple[Any, ...], Surveyed] = {}
        self.partition = Partition(system, points, watched)
        names = {n: [port.variable for port in watched if port.instance == n] for n in system.instances}
        self._benches = Benches(system, names)
        hermite = MASTERS["jacobi"](extrapolation="hermite")
        # The highest degree of a signal that participants follow.
        self.highest = max(self._benches.of(point, hermite, 1).highest for point in points)
        self._first = scenario.macro_step / DOWN
        self._longest = min(UP * scenario.macro_step, scenario.stop_time)
        probe = MASTERS["jacobi"]()
        self.hardest, _ = hardest(points, probe, self._first, self._longest, self._benches)
        sources = Behaviour(points[0], probe, self._benches).sources
        self._sampled: Sampled = sampled(where, system, sources)
        self._names = {str(port): sources.index(port) for port in watched}
        self.typical = self._typical()

    def _typical(self) -> Point:
        """The point about which errors are carried along the course: of median errors, or, where events
        change what a participant is, of the largest."""
        kind = MASTERS["gauss_seidel"]
        excess = []
        for point in self.points:
            behaviour = Behaviour(point, kind(), self._benches)
            excess.append(self._excess(self._errors(behaviour, FINER)))
        events = any(i.component.events for i in self.system.instances.values())
        return self.points[int(np.argsort(excess)[-1 if events else len(excess) // 2])]

    def order(self) -> tuple[str, ...]:
        """The order in which a Gauss-Seidel sweep is the most stable, and of equals the most accurate."""
        kind = MASTERS["gauss_seidel"]
        orders = list(self.partition.orders())
        if len(orders) == 1:
            return orders[0]
        listed = Behaviour(self.hardest, kind(), self._benches)
        limit = largest_stable(listed, self._first, self._longest, [])
        beyond = min(1.5 * limit, self._longest)
        radius = {
            order: Behaviour(self.hardest, kind(order=order), self._benches).at(beyond).radius
            for order in orders
        }
        least = min(radius.values())
        equal = [order for order in orders if radius[order] <= 1.001 * least]
        step = self.scenario.macro_step
        if len(equal) == 1 or not limit > step:
            return equal[0]
        return min(
            equal,
            key=lambda order: max(
                self._errors(Behaviour(self.typical, kind(order=order), self._benches), FINER).values()
            ),
        )

    def method(self, master: Master) -> Surveyed:
        """All that is known of a master; of implicit ones the converged step only once.

        It is the same whichever way it was found; what it costs is not.
        """
        key = (master.degree, getattr(master, "order", ()), getattr(master, "iterate", ()))
        if master.implicit and key in self._converged:
            found = replace(self._converged[key], master=master)
        else:
            found = self._stability(master)
            self._measure(found)
            if master.implicit and all(math.isfinite(at.radius) for at in found.seen):
                self._converged[key] = replace(found)
        self._effort(found)
        return found

    def _stability(self, master: Master) -> Surveyed:
        found = Surveyed(master)
        worst = Behaviour(self.hardest, master, self._benches)
        found.limit = largest_stable(worst, self._first, self._longest, found.seen)
        found.hardest = self.hardest.time
        for point in self.points:
            other = Behaviour(point, master, self._benches)
            just = min(ALMOST * found.limit, self._longest)
            if found.limit > 0.0 and not other.at(just).stable:
                found.limit = min(found.limit, largest_stable(other, self._first, just, []))
                worst, found.hardest = other, point.time
        if found.limit < math.inf:
            found.culprit = worst.culprit(1.1 * found.limit)
        return found

    def _errors(self, behaviour: Behaviour, factor: int) -> dict[str, float]:
        """Predicted errors at `factor` intervals of the course a macro step."""
        operator = behaviour.operator(factor * self._sampled.interval)
        if operator is None:
            return dict.fromkeys(self._names, math.inf)
        found = predicted(operator, self._sampled, factor, behaviour.nominal)
        return {name: float(found[i]) for name, i in self._names.items()}

    def _measure(self, found: Surveyed) -> None:
        """Errors against the step, and the largest steps that stability and tolerance allow."""
        step, interval = self.scenario.macro_step, self._sampled.interval
        factor, behaviour = FINER, Behaviour(self.typical, found.master, self._benches)
        while factor * interval < found.limit and len(self._sampled.values) > 8 * factor:
            # Only the hardest point was scanned: this one may have an island of instability of its own.
            if not behaviour.at(factor * interval).stable:
                found.limit = largest_stable(behaviour, self._first, factor * interval, [])
                found.culprit, found.hardest = behaviour.culprit(factor * interval), self.typical.time
                break
            found.errors[factor * interval] = errors = self._errors(behaviour, factor)
            if factor * interval >= self._longest or self._excess(errors) > 100.0:
                break
            factor *= 2
        if interval < found.limit and self._excess(found.errors.get(step, {})) > 1.0:
            found.errors[interval] = self._errors(behaviour, 1)
        found.errors = dict(sorted(found.errors.items()))
        lowest = int(min(behaviour.degrees))
        order = 4 if lowest == HERMITE else lowest + 1
        excess = {at: self._excess(errors) for at, errors in found.errors.items()}
        found.within = reached(excess, order, 1.0)
        safe = min(reached(excess, order, 1.0 / WITHIN), found.limit / AWAY, self._longest)
        found.recommended = rounded_down(safe)

    def _effort(self, found: Surveyed) -> None:
        """What the advised step costs; none is advised that a master's iteration cannot make."""
        if not found.recommended > 0.0:
            return
        interval = self._sampled.interval
        factor = max(1, round(found.recommended / interval))
        behaviour = Behaviour(self.typical, found.master, self._benches)
        missed = self._sampled.missed(factor, behaviour.degrees)
        amounts = (np.sqrt(np.mean(missed**2, axis=0)) / behaviour.nominal).ravel()
        found.cost = behaviour.effort(found.recommended, amounts) / found.recommended
        if not math.isfinite(found.cost):
            found.recommended = 0.0

    def _excess(self, errors: Mapping[str, float]) -> float:
        """The largest error over its tolerance."""
        return max(
            (error / self.scenario.tolerance[name] for name, error in errors.items()), default=math.inf
        )
