"""A macro step that was made, and what set its length."""

from typing import NamedTuple

# What set the length of a step, by number in result files.
FIXED, ERROR, LONGEST, STOP, EVENT, TIME_EVENT, SHORTEST, CONVERGENCE, DISCARD, GROWTH = range(10)
REASONS = (
    "fixed", "error", "maximum_step", "stop_time", "event", "time_event", "discontinuity", "convergence",
    "discard", "growth",
)  # fmt: skip


class Step(NamedTuple):
    """A macro step that was made, from `end - length` to `end`.

    `iterations` of its last attempt; `rejected` attempts before; `error` estimated, over what is allowed;
    `source` the exchanged value with most of it, or that set the step otherwise, by its number among all
    outputs of the system (-1: none); `reason` what set the length; `parts` are the equal ones in which it
    was made.
    """

    end: float
    length: float
    iterations: int
    rejected: int = 0
    error: float = 0.0
    source: int = -1
    reason: int = FIXED
    parts: int = 1
