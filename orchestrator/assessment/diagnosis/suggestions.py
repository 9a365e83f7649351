"""Suggestions that follow from a run's numbers. To add one: a rule, listed in RULES.

Each rule states in its docstring when it speaks.
"""

from collections.abc import Callable

import numpy as np

from ...engine.signals import DEGREES
from ...engine.step import REASONS
from ...scenario import CONVERGED
from ...scenario.units import format_time
from .facts import Facts

MOST = 0.5  # of the steps: what sets so many is what limits the run
OFTEN = 0.1  # of the attempts, or of the steps


def percent(share: float) -> str:
    """A share as it is written."""
    if 0.0 < share < 0.001:
        return "< 0.1 %"
    return f"{100.0 * share:.2g} %" if share < 0.995 else "100 %"


NEARLY_ALL = 0.9  # of the steps limited by errors
WORTH = 0.05  # of the doStep calls: a saving of less is not worth a change


def stiff_connection(facts: Facts) -> str | None:
    """One variable's error limits most steps under a master that does not iterate."""
    name, share = facts.limiting
    if share < MOST or facts.master.implicit or not facts.limits.restorable or not facts.is_felt(name):
        return None
    signal = list(DEGREES)[facts.limits.useful_degree]
    return (
        f"{name} limits {percent(share)} of the steps: {_coupling(facts, name)}; fast motion needs them, but "
        "where `tribocosim analyse` shows a stiff coupling, try "
        f'[master] name = "iterated", extrapolation = "{signal}"'
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
        f"{name} limits {percent(share)} of the steps: {_coupling(facts, name)}; iterate only "
        f"{', '.join(part)} ([master] iterate = [{', '.join(map(_quote, part))}]), about {percent(saved)} "
        "fewer doStep calls at equal steps"
    )


def higher_degree(facts: Facts) -> str | None:
    """Most steps are limited by the error of held or linear signals."""
    share = facts.diagnosis.share("error")
    if share < MOST or facts.master.degree > 1 or not facts.diagnosis.limits:
        return None
    better = list(DEGREES)[min(facts.limits.useful_degree, 3 if facts.master.implicit else 2)]
    if DEGREES[better] <= facts.master.degree:
        return None
    used = list(DEGREES)[facts.master.degree]
    return (
        f"the error of the coupling limits {percent(share)} of the steps, with {used} signals: [master] "
        f'extrapolation = "{better}" allows longer ones'
    )


def suggest_held_inputs(facts: Facts) -> str | None:
    """Steps of one length with held inputs."""
    if facts.scenario.step_control or facts.master.degree > 0:
        return None
    better = min(facts.limits.useful_degree, 2)
    remedies = [f'[master] extrapolation = "{list(DEGREES)[better]}"'] if better else []
    remedies += ["[step_control]"] if facts.limits.controllable else []
    return (
        "steps of one length with held inputs: their error falls only with the first power of macro_step; "
        f"{', or '.join(remedies) or 'a shorter macro_step'}"
    )


def _coupling(facts: Facts, variable: str) -> str:
    """The coupling that a variable belongs to, in words."""
    own, *others = sorted(facts.around(variable), key=lambda name: name != variable.split(".")[0])
    if others:
        return f"the coupling {own} <-> {', '.join(others)}"
    return f"its connection to {', '.join(facts.targets.get(variable, ['nothing']))}"


def _quote(name: str) -> str:
    return f'"{name}"'


MANY_ITERATIONS = 5.0  # a step; a smooth coupling with good signals takes two or three
DENSE = 3.0  # times the mean work


def uneven_work(facts: Facts) -> str | None:
    """Steps of one length need many times more iterations in some intervals than in others."""
    dense = max(facts.diagnosis.densest, key=lambda interval: interval.density, default=None)
    controlled = facts.scenario.step_control or not facts.limits.controllable
    if controlled or dense is None or dense.density < DENSE:
        return None
    return (
        f"{percent(dense.work)} of the iterations fall in {percent(dense.time)} of the time, "
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
            f"[master] maximum_iterations = {most}, or step_control.maximum_step = "
            f'"{format_time(d.length["p95"])}"'
        )
    return f"{percent(share)} of the attempts were rejected because the iteration did not converge: {remedy}"


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
        f"step_control.maximum_step (now the longest are {format_time(facts.diagnosis.length['p95'])})"
        if control
        else f"macro_step (now {format_time(facts.scenario.macro_step)})"
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


SHORT = 0.1  # of the time
FEW = 10  # steps, in which a length grows a thousandfold


def suggest_longer_start(facts: Facts) -> str | None:
    """The first step is so short that many steps only grow from it."""
    growing = facts.steps.reason == REASONS.index("growth")
    first = int(np.argmin(growing)) if not growing.all() else len(growing)
    if facts.scenario.step_control is None or first < max(FEW, OFTEN * len(growing)):
        return None
    reached = float(facts.steps.length[:first].max())
    return (
        f"the first {first} steps ({percent(first / len(growing))}) only grow, from macro_step = "
        f'{format_time(facts.scenario.macro_step)}: macro_step = "{format_time(reached)}", where they '
        "arrive, saves them"
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
        f"{percent(share)} of the steps were cut at step_control.maximum_step = "
        f"{format_time(control.maximum_step)}, with {error:.2g} of the allowed error in the median: raise it"
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
        f"{total} attempts were rejected for their error, in {percent(around)} of the time, most at "
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
        f"{percent(share)} of the attempts were refused by a participant: give it retries (components.NAME."
        f'retries = 3), or step_control.maximum_step = "{format_time(d.length["p95"])}"'
    )


def chatter(facts: Facts) -> str | None:
    """Events end many steps."""
    share = facts.diagnosis.share("event")
    if share < OFTEN:
        return None
    name, count = max(facts.diagnosis.events.items(), key=lambda item: item[1])
    return (
        f"events end {percent(share)} of the steps, {count} of them told by {name}: a longer event_"
        "tolerance steps over events that follow each other within a hundred tolerances"
    )


Rule = Callable[[Facts], str | None]

RULES: list[Rule] = [
    stiff_connection, smaller_part, higher_degree, suggest_held_inputs, uneven_work, convergence,
    many_iterations, suggest_longer_start, longest, discontinuity, rough, discards, chatter, costly_estimator,
]  # fmt: skip


# What a survey has decided where auto chose, so that the coupling is stable with the least work.
SURVEYED = (stiff_connection, smaller_part, higher_degree, suggest_held_inputs, longest)


def suggestions(facts: Facts) -> list[str]:
    """What the rules say."""
    rules = (rule for rule in RULES if not (facts.scenario.master.chosen and rule in SURVEYED))
    return [said for rule in rules if (said := rule(facts))]
