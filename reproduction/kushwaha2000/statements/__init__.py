"""Every quantitative statement of the source, in its order.

To add one: a function from `Runs` to a `Statement` in the file of its subject, listed in the file's tuple.
"""

from __future__ import annotations

from . import contact, equations, film, film_formula, kinematics, load, parts
from .check import Check

CHECKS: tuple[Check, ...] = (
    *contact.ABSTRACT,
    *parts.BEFORE,
    *contact.CHECKS,
    *film_formula.BEFORE,
    *equations.CHECKS,
    *film_formula.EQUATIONS,
    *parts.EQUATIONS,
    *load.START,
    *film.LOW,
    *kinematics.CHECKS,
    *film.KINEMATIC,
    *kinematics.NOSE,
    *film.NOSE,
    *load.SPEED,
    *film.SPEED,
    *load.CROSSING,
    *load.FLEXIBLE,
    *kinematics.FORMULA,
)

__all__ = ["CHECKS", "Check"]
