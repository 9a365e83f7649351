"""The diagnosis in sentences: where the time went, who limits the step, and what to change."""

from collections.abc import Sequence

import numpy as np

from models.core.words import tally

from ...engine.step import REASONS
from ...errors import Command, Set, in_command_line
from ...scenario.units import format_time
from ...store.output_folder import format_path
from .facts import Facts
from .suggestions import percent
from .times import MUCH, Part, Spending

WORTH_TELLING = 0.1  # of the time
# An error below this share of what is allowed may grow by as much as steps are made longer.
WELL_WITHIN = 0.1
LIMITING = {
    "fixed": "every step has the length `macro_step`",
    "maximum_step": "the step is limited by `step_control.maximum_step`",
    "stop_time": "the run ends with its first steps",
    "event": "located events end the steps",
    "time_event": "events at known times end the steps",
    "discontinuity": "the step is limited by `step_control.minimum_step`: outputs jump",
    "convergence": "the step is limited by iterations that do not converge",
    "discard": "the step is limited by participants that refuse longer ones",
    "growth": "the step still grows from a shorter one",
}


def answer(facts: Facts, spending: Spending, parts: Sequence[Part], suggestions: Sequence[str]) -> list[str]:
    """Three sentences; the first only where the run left its times."""
    return [*_tell_time(spending, parts), _tell_limit(facts), _tell_change(facts, spending, suggestions)]


def _tell_time(spending: Spending, parts: Sequence[Part]) -> list[str]:
    if not parts:
        return []
    wall, once, said = spending.wall_s, [part for part in parts if part.once], "of the "
    if (spent := sum(part.seconds for part in once)) > WORTH_TELLING * wall:
        names = " and ".join(part.name for part in once)
        said = (
            f"{names} took {percent(spent / wall)} of the {wall:.3g} s, once on this machine; of the other "
        )
    left = wall - spent if spent > WORTH_TELLING * wall else wall
    first, second, *_ = [part for part in parts if not part.once] + 2 * [Part("", 0.0)]
    said += f"{left:.3g} s, {percent(first.seconds / left)} went into {first.name}"
    said += f" ({first.remedy})" if first.remedy else ""
    if first.seconds < MUCH * left:
        said += f" and {percent(second.seconds / left)} into {second.name}"
    return [f"Time: {said}."]


def _tell_limit(facts: Facts) -> str:
    """What sets most steps, and who has most of the refused attempts."""
    d = facts.diagnosis
    reason, share = next(iter(d.reasons.items()))
    length = f"{format_time(d.length['median'])} in the median"
    if reason == "error" and d.limits:
        variable, limit = next(iter(d.limits.items()))
        name, _, output = variable.partition(".")
        said = (
            f"participant {name} limits {percent(limit.steps)} of the {d.steps} steps by its output {output}"
        )
    else:
        said = LIMITING.get(reason, "the step is limited by the error of the coupling")
        said += f" in {percent(share.steps)} of the {d.steps} steps" if share.steps < 1.0 else ""
    return f"Step: {said}; {length}{_tell_refused(facts)}."


def _tell_refused(facts: Facts) -> str:
    """The cause of most refused attempts."""
    d, steps = facts.diagnosis, facts.steps
    if not d.rejected:
        return ""
    said = f"; refused: {tally(d.rejected, 'attempt')} ({percent(d.rejected_share)})"
    reason, count = max(d.rejections.items(), key=lambda item: item[1])
    own = steps.reason == REASONS.index(reason)
    sources = np.bincount(steps.source[own] + 1, steps.rejected[own])
    worst = int(np.argmax(sources))
    of = f" of {steps.name(worst - 1)}" if worst else ""
    words = {"error": "for the error", "convergence": "for iterations that did not converge"}
    why = words.get(reason, f"before a step set by {reason}")
    return f"{said}, {percent(count / d.rejected)} of them {why}{of}"


def _tell_change(facts: Facts, spending: Spending, suggestions: Sequence[str]) -> str:
    """The first suggestion; without one what the error leaves room for."""
    if suggestions:
        return f"Change: {suggestions[0]}."
    output, share = spending.error
    control, scenario = facts.scenario.step_control, facts.scenario
    subject = format_path(scenario.origin.path) if scenario.origin else scenario.name
    if output and share < WELL_WITHIN and next(iter(facts.diagnosis.reasons)) in ("error", "fixed"):
        key, value = (
            ("step_control.relative", control.relative) if control else ("macro_step", scenario.macro_step)
        )
        more = (0.5 / max(share, 0.05) if control else 2.0) * value
        longer = Set(key, f"{more:.2g}" if control else format_time(more))
        words = "`", longer, "` for fewer steps; `", Command("masters", (subject,)), "` compares others."
        said = f"Change: {output}, the least exact, has {percent(share)} of the error allowed: try "
        return in_command_line((said, words))
    if not output:
        return (
            "Change: none is advised for the steps; whether their error leaves room for longer ones only a "
            "reference shows (`reference.enabled = true`, with a `tolerance`)."
        )
    return f"Change: none is advised for the steps; {output} has {percent(share)} of the error allowed."
