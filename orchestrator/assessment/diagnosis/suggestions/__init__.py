"""Suggestions that follow from a run's numbers. To add one: a rule, listed in RULES.

Each rule states in its docstring when it speaks.
"""

from collections.abc import Callable

from ..facts import Facts
from .coupling import higher_degree, smaller_part, stiff_connection, suggest_held_inputs
from .iteration import convergence, costly_estimator, many_iterations, uneven_work
from .step_length import chatter, discards, discontinuity, longest, rough, suggest_longer_start

Rule = Callable[[Facts], str | None]

RULES: list[Rule] = [
    stiff_connection, smaller_part, higher_degree, suggest_held_inputs, uneven_work, convergence,
    many_iterations, suggest_longer_start, longest, discontinuity, rough, discards, chatter, costly_estimator,
]  # fmt: skip


def suggestions(facts: Facts) -> list[str]:
    """What the rules say."""
    return [said for rule in RULES if (said := rule(facts))]
