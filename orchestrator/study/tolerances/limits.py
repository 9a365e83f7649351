"""Limits on figures of merit, such as "seating_velocity < 0.4 m/s"."""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from models.core.quantities import Vector

from ...analyses import Result
from ...errors import MistakeError, one_of
from ...scenario.units import UnitError, is_bare, to_unit

_LIMIT = re.compile(r"\s*([\w.\[\]-]+)\s*(<=?|>=?)\s*(.+?)\s*")


@dataclass(frozen=True)
class Limit:
    """A figure "part.name" that must be less, or more, than `value` (SI)."""

    text: str
    figure: str
    upper: bool
    value: float

    def holds(self, values: Vector) -> NDArray[np.bool_]:
        """Not for a figure that there is none of."""
        return np.asarray(values <= self.value if self.upper else values >= self.value)


def parse_limits(texts: Sequence[str], results: Mapping[str, Result]) -> list[Limit]:
    """MistakeError for a limit that names no figure or no value, and for two that no train can keep."""
    limits = [_parse(text, results) for text in texts]
    for figure in dict.fromkeys(limit.figure for limit in limits):
        own = [limit for limit in limits if limit.figure == figure]
        low = max((one for one in own if not one.upper), key=lambda one: one.value, default=None)
        high = min((one for one in own if one.upper), key=lambda one: one.value, default=None)
        if low and high and not low.value < high.value:
            raise MistakeError(f"limits: no train keeps both {low.text!r} and {high.text!r}; change one")
    return limits


def _parse(text: str, results: Mapping[str, Result]) -> Limit:
    match = _LIMIT.fullmatch(text)
    if match is None:
        raise MistakeError(
            f"limits: {text!r}: write a figure, < or >, and a value, as 'seating_velocity < 0.4 m/s'"
        )
    name, sign, value = match.groups()
    named = [known for known in results if name in (known, known.rpartition(".")[2])]
    if not named:
        names = dict.fromkeys([known.rpartition(".")[2] for known in results] if "." not in name else results)
        raise MistakeError(f"limits: {text!r}: no figure {name}; {one_of(names, name)}")
    if len(named) > 1:
        raise MistakeError(f"limits: {text!r}: several parts have {name}; write one of {', '.join(named)}")
    unit = results[named[0]].unit
    if is_bare(value) and unit != "1":
        raise MistakeError(f"limits: {text!r}: write the value with its unit, as {value} {unit}")
    try:
        return Limit(text, named[0], sign[0] == "<", to_unit(value, unit))
    except UnitError as error:
        raise MistakeError(f"limits: {text!r}: {error}") from None
