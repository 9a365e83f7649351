"""Every statement of F that can be computed or contradicts another, in F's order.

To add one: a function from `Runs` to a `Statement` in the file of its subject, listed in the file's tuple.
"""

from __future__ import annotations

from . import (
    chaos,
    classification,
    derivation,
    discussion,
    engine,
    force,
    force_law,
    lower_wall,
    methods,
    nonsliding,
    restitution,
    sliding,
    walls,
)
from .judging import Check

CHECKS: tuple[Check, ...] = (
    *discussion.ABSTRACT,
    *restitution.CAPTIONS,
    *derivation.CHECKS,
    *walls.CHECKS,
    *walls.SLIDING,
    *force.REGIONS,
    *force_law.CHECKS,
    *force.CHECKS,
    *methods.CHECKS,
    *engine.CHECKS,
    *chaos.CHECKS,
    *nonsliding.BEFORE,
    *classification.CHECKS,
    *nonsliding.CHECKS,
    *sliding.CHECKS,
    *lower_wall.CHECKS,
    *restitution.CHECKS,
    *restitution.DISCUSSION,
    *discussion.CHECKS,
)

__all__ = ["CHECKS", "Check"]
