"""Rules on which connection is the stiff one, and on its signals."""

from ....engine.signals import DEGREES
from ..facts import Facts
from .marks import MOST, percent

NEARLY_ALL = 0.9  # of the steps limited by errors
WORTH = 0.05  # of the doStep calls: a saving of less is not worth a change


def stiff_connection(facts: Facts) -> str | None:
    """One variable's error limits most steps under a master that does not iterate."""
    name, share = facts.limiting
    if share < MOST or facts.master.implicit or not facts.limits.restorable or not facts.is_felt(name):
        return None
    signal = list(DEGREES)[facts.limits.lowest_degree]
    return (
        f"{name} limits {percent(share)} of the steps: {_coupling(facts, name)}; an explicit master's "
        f'error, not the motion, may set the step: [master] name = "iterated", extrapolation = "{signal}"'
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
    better = list(DEGREES)[min(facts.limits.lowest_degree, 3 if facts.master.implicit else 2)]
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
    better = min(facts.limits.lowest_degree, 2)
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
        return f"the coupling {own} <-> {', '.join(others)} is the stiff one"
    return f"its connection to {', '.join(facts.targets.get(variable, ['nothing']))} is the fast one"


def _quote(name: str) -> str:
    return f'"{name}"'
