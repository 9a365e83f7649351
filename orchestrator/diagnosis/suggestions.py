"""Suggestions that follow from a run's numbers. To add one: a rule, listed in RULES.

Each rule states in its docstring when it speaks. The shares from which a rule speaks are marks of what is
worth a user's time, not physics.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from ..scenario import CONVERGED, Scenario, ends
from ..signals import DEGREES
from ..stepping import REASONS
from .numbers import Diagnosis
from .steps import Steps

MOST = 0.5  # of the steps: what sets so many is what limits the run
NEARLY_ALL = 0.9
OFTEN = 0.1  # of the attempts, or of the steps
MANY_ITERATIONS = 5.0  # a step; a smooth coupling with good signals takes two or three
WORTH = 0.05  # of the doStep calls: a saving of less is not worth a change
SHORT = 0.1  # of the time
DENSE = 3.0  # times the mean work


@dataclass(frozen=True)
class Facts:
    """What rules look at."""

    diagnosis: Diagnosis
    steps: Steps
    scenario: Scenario

    @cached_property
    def master(self) -> Any:
        """With the tolerance that it ran with."""
        return self.scenario.made_master()

    @cached_property
    def targets(self) -> dict[str, list[str]]:
        """The inputs that each output drives."""
        found: dict[str, list[str]] = {}
        for source, target in map(ends, self.scenario.connections):
            found.setdefault(source, []).append(target)
        return found

    @cached_property
    def drives(self) -> dict[str, set[str]]:
        """The participants that each participant drives."""
        found: dict[str, set[str]] = {name: set() for name in self.scenario.components}
        for source, target in map(ends, self.scenario.connections):
            found[source.split(".")[0]].add(target.split(".")[0])
        return found

    @property
    def weaker(self) -> bool:
        """The master accelerates its iteration, with less than there is."""
        return getattr(self.master, "acceleration", "quasi_newton") != "quasi_newton"

    def around(self, variable: str) -> list[str]:
        """The participant that gives `variable`, and those that it drives by it and that drive it."""
        own = variable.split(".")[0]
        driven = {target.split(".")[0] for target in self.targets.get(variable, ())}
        return [n for n in self.drives if n == own or (n in driven and own in self.drives[n])]

    def loop(self, name: str) -> set[str]:
        """The participants from which and to which one comes from `name`."""
        return {other for other in self._reached(name) if name in self._reached(other)}

    def _reached(self, name: str) -> set[str]:
        seen, waiting = {name}, [name]
        while waiting:
            new = self.drives[waiting.pop()] - seen
            seen |= new
            waiting += new
        return seen

    @property
    def limiting(self) -> tuple[str, float]:
        """The variable whose error limits most steps, and its share of all steps."""
        name = next(iter(self.diagnosis.limits), "")
        return name, self.diagnosis.limits[name].steps if name else 0.0


Rule = Callable[[Facts], str | None]


def stiff_connection(facts: Facts) -> str | None:
    """One variable's error limits most steps under a master that does not iterate."""
    name, share = facts.limiting
    if share < MOST or facts.master.implicit:
        return None
    return (
        f"{name} limits {_percent(share)} of the steps: {_coupling(facts, name)}; an explicit master's "
        'error, not the motion, may set the step: [master] name = "iterated", extrapolation = "hermite"'
    )


def smaller_part(facts: Facts) -> str | None:
    """One variable limits most steps, its close neighbours nearly all, and more than these is iterated."""
    name, share = facts.limiting
    if share < MOST or not facts.master.implicit or facts.master.iterate:
        return None
    part = facts.around(name)
    others = len(facts.loop(name.split(".")[0]) - set(part))
    limits = facts.diagnosis.limits
    inside = sum(limit.steps for variable, limit in limits.items() if variable.split(".")[0] in part)
    saved = (1.0 - 1.0 / facts.diagnosis.mean_iterations) * others / len(facts.drives)
    if len(part) < 2 or inside < NEARLY_ALL * sum(limit.steps for limit in limits.values()) or saved < WORTH:
        return None
    return (
        f"{name} limits {_percent(share)} of the steps: {_coupling(facts, name)}; iterate only "
        f"{', '.join(part)} ([master] iterate = [{', '.join(map(_quoted, part))}]), about {_percent(saved)} "
        "fewer doStep calls at equal steps"
    )


def higher_degree(facts: Facts) -> str | None:
    """Most steps are limited by the error of held or linear signals."""
    share = facts.diagnosis.share("error")
    if share < MOST or facts.master.degree > 1 or not facts.diagnosis.limits:
        return None
    better = "hermite" if facts.master.implicit else "quadratic"
    used = list(DEGREES)[facts.master.degree]
    return (
        f"the error of the coupling limits {_percent(share)} of the steps, with {used} signals: [master] "
        f'extrapolation = "{better}" allows longer ones'
    )


def held_inputs(facts: Facts) -> str | None:
    """Steps of one length with held inputs."""
    if facts.scenario.step_control or facts.master.degree > 0:
        return None
    return (
        "steps of one length with held inputs: their error falls only with the first power of macro_step; "
        '[master] extrapolation = "quadratic", or [step_control]'
    )


def uneven_work(facts: Facts) -> str | None:
    """Steps of one length need many times more iterations in some intervals than in others."""
    dense = max(facts.diagnosis.densest, key=lambda interval: interval.density, default=None)
    if facts.scenario.step_control or dense is None or dense.density < DENSE:
        return None
    return (
        f"{_percent(dense.work)} of the iterations fall in {_percent(dense.time)} of the time, "
        f"{dense.start:.6g} to {dense.end:.6g} s: [step_control] shortens the steps only there"
    )


def convergence(facts: Facts) -> str | None:
    """Many attempts are rejected because the iteration does not converge."""
    d = facts.diagnosis
    share = d.rejections.get("convergence", 0) / (d.steps + d.rejected)
    if share < OFTEN:
        return None
    if facts.weaker:
        remedy = '[master] acceleration = "quasi_newton"'
    elif facts.scenario.master.name == "iterated":
        remedy = '[master] name = "newton"'
    else:
        most = 2 * facts.master.maximum_iterations
        remedy = (
            f'[master] maximum_iterations = {most}, or step_control.maximum_step = "{d.length["p95"]:.2g} s"'
        )
    return f"{_percent(share)} of the attempts were rejected because the iteration did not converge: {remedy}"


def many_iterations(facts: Facts) -> str | None:
    """Many iterations a step, and a sharper tolerance than needed, or a weaker acceleration than there is."""
    mean = facts.diagnosis.mean_iterations
    if not facts.master.implicit or mean < MANY_ITERATIONS:
        return None
    said = f"{mean:.1f} iterations a step: "
    control, tolerance = facts.scenario.step_control, facts.master.tolerance
    if control and tolerance < CONVERGED * control.relative * (1.0 - 1e-9):
        needed = CONVERGED * control.relative
        return (
            f"{said}loosen master.tolerance (now {tolerance:g}) to {needed:g}, {CONVERGED:g} of "
            "step_control.relative, or leave it out"
        )
    if facts.weaker:
        return f'{said}[master] acceleration = "quasi_newton" goes on with what earlier steps learnt'
    return f"{said}the iteration contracts faster with shorter steps: lower " + (
        f"step_control.maximum_step (now the longest are {facts.diagnosis.length['p95']:.2g} s)"
        if control
        else f"macro_step (now {facts.scenario.macro_step:g} s)"
    )


def longest(facts: Facts) -> str | None:
    """Most steps are cut at maximum_step although their error would allow more."""
    share = facts.diagnosis.share("maximum_step")
    control = facts.scenario.step_control
    if share < MOST or control is None or control.maximum_step is None:
        return None
    chosen = facts.steps.reason == REASONS.index("maximum_step")
    error = float(np.median(facts.steps.error[chosen]))
    return (
        f"{_percent(share)} of the steps were cut at step_control.maximum_step = {control.maximum_step:g} s, "
        f"with {error:.2g} of the allowed error in the median: raise it"
    )


def discontinuity(facts: Facts) -> str | None:
    """The error stayed over the tolerance at the shortest step."""
    if not facts.diagnosis.discontinuities:
        return None
    time, variable = facts.diagnosis.discontinuities[0]
    others = round(facts.diagnosis.share("discontinuity") * facts.diagnosis.steps) - 1
    more = f" (and {others} more)" if others else ""
    return (
        f"minimum step reached at t = {time:.9g} s{more}: discontinuity of {variable}; an event_indicator of "
        "its component would have it located, a smooth input would have none"
    )


def rough(facts: Facts) -> str | None:
    """Most attempts rejected for their error lie in a small part of the time."""
    d, steps = facts.diagnosis, facts.steps
    rejected = np.where(steps.reason == REASONS.index("error"), steps.rejected, 0)
    total = int(rejected.sum())
    if total < OFTEN * (d.steps + d.rejected):
        return None
    held = np.sort(steps.end[rejected > 0])
    around = float(steps.length[rejected > 0].sum()) / (d.end - d.start)
    if around > SHORT or not held.size:
        return None
    worst = int(np.argmax(rejected))
    return (
        f"{total} attempts were rejected for their error, in {_percent(around)} of the time, most at "
        f"t = {steps.end[worst]:.6g} s for {steps.name(int(steps.source[worst]))}: something changes fast or "
        "is not smooth there; located events (event_indicators of the component) cost less"
    )


def discards(facts: Facts) -> str | None:
    """Participants refuse many attempts."""
    d = facts.diagnosis
    share = d.rejections.get("discard", 0) / (d.steps + d.rejected)
    if share < OFTEN:
        return None
    return (
        f"{_percent(share)} of the attempts were refused by a participant: give it retries (components.NAME."
        f'retries = 3), or step_control.maximum_step = "{d.length["p95"]:.2g} s"'
    )


def chatter(facts: Facts) -> str | None:
    """Events end many steps."""
    share = facts.diagnosis.share("event")
    if share < OFTEN:
        return None
    name, count = max(facts.diagnosis.events.items(), key=lambda item: item[1])
    return (
        f"events end {_percent(share)} of the steps, {count} of them told by {name}: a longer event_"
        "tolerance steps over events that follow each other within a hundred tolerances"
    )


def costly_estimator(facts: Facts) -> str | None:
    """Step doubling where the iteration gives an estimate for nothing."""
    control = facts.scenario.step_control
    if control is None or control.estimator != "step_doubling" or not facts.master.implicit:
        return None
    return (
        'step_control.estimator = "step_doubling" makes every step three times: "predictor_corrector" takes '
        "its estimate from the iteration"
    )


RULES: list[Rule] = [
    stiff_connection,
    smaller_part,
    higher_degree,
    held_inputs,
    uneven_work,
    convergence,
    many_iterations,
    longest,
    discontinuity,
    rough,
    discards,
    chatter,
    costly_estimator,
]


def suggestions(facts: Facts) -> list[str]:
    """What the rules say."""
    return [said for rule in RULES if (said := rule(facts))]


def _coupling(facts: Facts, variable: str) -> str:
    """The coupling that a variable belongs to, in words."""
    own, *others = sorted(facts.around(variable), key=lambda name: name != variable.split(".")[0])
    if others:
        return f"the coupling {own} <-> {', '.join(others)} is the stiff one"
    return f"its connection to {', '.join(facts.targets.get(variable, ['nothing']))} is the fast one"


def _percent(share: float) -> str:
    return f"{100.0 * share:.2g} %" if share < 0.995 else "100 %"


def _quoted(name: str) -> str:
    return f'"{name}"'
