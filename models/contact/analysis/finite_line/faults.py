"""What a user can get wrong: messages name the thing, its value, what is allowed and what to do."""

from __future__ import annotations

import math

from ....core.system import ModelError


def out_of_range(name: str, value: float, unit: str, bound: str, remedy: str) -> ModelError:
    return ModelError(f"{name} = {value:g} {unit}: must be {bound}; {remedy}")


def require_positive(name: str, value: float, unit: str, remedy: str) -> None:
    """ModelError unless value > 0 (infinity passes, nan does not)."""
    if not value > 0.0:
        raise out_of_range(name, value, unit, "positive", remedy)


def require_not_negative(name: str, value: float, unit: str, remedy: str) -> None:
    """ModelError unless 0 <= value < infinity."""
    if not (value >= 0.0 and math.isfinite(value)):
        raise out_of_range(name, value, unit, "not negative", remedy)


def require_finite(name: str, value: float, unit: str, remedy: str) -> None:
    if not math.isfinite(value):
        raise out_of_range(name, value, unit, "finite", remedy)
