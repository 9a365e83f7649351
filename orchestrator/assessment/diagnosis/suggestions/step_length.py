"""Rules on what keeps steps short."""

import numpy as np

from ....engine.step import REASONS
from ..facts import Facts
from .marks import MOST, OFTEN, percent

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
        f'{facts.scenario.macro_step:g} s: macro_step = "{reached:.2g} s", where they arrive, saves them'
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
        f"{percent(share)} of the steps were cut at step_control.maximum_step = {control.maximum_step:g} s, "
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
        f'retries = 3), or step_control.maximum_step = "{d.length["p95"]:.2g} s"'
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
