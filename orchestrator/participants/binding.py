"""Variables of an FMU bound to memory.

One call transfers all doubles, and one all variables of each other type. Arrays of FMI 3 go as a whole.
"""

from collections.abc import Callable, Iterable, Mapping
from functools import partial
from typing import Any

import numpy as np

from models.core.quantities import Vector

from ..errors import ParticipantError
from .description import EXACT, INTEGERS, REALS, Variable, find_range
from .fmi_instance import Fail, FmiInstance, Transfer

# Whole numbers that factors made are off by no more than this, or this part.
WHOLE, ROUNDED = 1e-6, 1e-15


def find_array(known: Mapping[str, Variable], variable: Variable) -> list[Variable]:
    """All elements of the variable's array in order, by the first of their names; a scalar alone."""
    if variable.size == 1:
        return [variable]
    found: dict[int, Variable] = {}
    for v in known.values():
        if v.memory[:2] == variable.memory[:2]:
            found.setdefault(v.place, v)
    return [found[place] for place in range(variable.size)]


class _Group:
    """Variables of one type in the memory of a call, with all elements of their arrays: these, their values
    at rest, the unique references, and at which place is the variable of which number."""

    def __init__(self) -> None:
        self.whole: list[Variable] = []
        self.rest: list[float] = []
        self.numbers: list[int] = []
        self.places: list[int] = []
        self._begins: dict[int, int] = {}

    def add(
        self, number: int, v: Variable, known: Mapping[str, Variable], given: Mapping[Any, float]
    ) -> None:
        """`given` has values at rest, by what variables stand for; others are start values."""
        if v.reference not in self._begins:
            self._begins[v.reference] = len(self.whole)
            array = find_array(known, v)
            self.whole += array
            self.rest += [given.get(one.memory, one.start or 0.0) for one in array]
        self.numbers.append(number)
        self.places.append(self._begins[v.reference] + v.place)

    @property
    def references(self) -> Any:
        return np.array(list(self._begins), dtype=np.uintc)


class VariableBinding:
    """Scalars bound to memory. `plain`: one call transfers all, as all are doubles and none of arrays.

    Other elements of an array that is set in part have the values in `fixed`, or their start values. `owner`
    is the participant's name, for messages.
    """

    def __init__(
        self,
        fmi: FmiInstance,
        known: Mapping[str, Variable],
        variables: Iterable[Variable],
        fixed: Mapping[str, float] | None = None,
        owner: str = "",
    ) -> None:
        self.fmi = fmi
        self._make_whole = partial(_to_whole, owner)
        given = {known[name].memory: value for name, value in (fixed or {}).items()}
        doubles, self._others, count = _Group(), dict[str, _Group](), 0
        for count, v in enumerate(variables, 1):
            double = v.type in fmi.real_types
            group = doubles if double else self._others.setdefault(v.type, _Group())
            group.add(count - 1, v, known, given)
        self.references = doubles.references
        self._rest = np.array(doubles.rest, dtype=float)
        self._numbers = np.array(doubles.numbers, dtype=np.int64)
        self._places = np.array(doubles.places, dtype=np.int64)
        self._values = np.zeros(count)
        self.plain = len(self._numbers) == len(self.references) == len(self._rest) == count

    def bind_set(self, fail: Fail, memory: Vector | None = None) -> None:
        """Prepare to set them; `memory` holds their values if they are plain."""
        self._bind(self.fmi.bind_setter, fail, memory, self._set_others)

    def bind_get(self, fail: Fail, memory: Vector | None = None) -> None:
        """Prepare to get them, as `bind_set`."""
        self._getters = [
            (group, *self.fmi.bind_typed_getter(kind, group.references, len(group.whole), fail))
            for kind, group in self._others.items()
        ]
        self._bind(self.fmi.bind_getter, fail, memory, self._get_others)

    def _bind(
        self, bind: Callable[..., Transfer], fail: Fail, memory: Vector | None, others: Callable[[], None]
    ) -> None:
        self._memory = self._rest.copy() if memory is None else memory
        transfer = bind(self.references, self._memory, fail)

        def transfer_all() -> None:
            transfer()
            others()

        # The FMU's function itself where that transfers all: it runs in every step.
        self.transfer = transfer_all if self._others else transfer

    def set_values(self, values: Vector) -> None:
        self._memory[self._places] = values[self._numbers]
        if self._others:
            self._values[:] = values
        self.transfer()

    def get_values(self) -> Vector:
        """Their values, in memory that the next call uses again."""
        self.transfer()
        self._values[self._numbers] = self._memory[self._places]
        return self._values

    def _set_others(self) -> None:
        for group in self._others.values():
            own, real = group.rest.copy(), group.whole[0].type in REALS
            for number, place in zip(group.numbers, group.places, strict=True):
                value = self._values[number]
                own[place] = value if real else self._make_whole(group.whole[place], value)
            self.fmi.set(group.whole, own)

    def _get_others(self) -> None:
        for group, memory, get in self._getters:
            get()
            self._values[group.numbers] = memory[group.places]


def _to_whole(end: str, variable: Variable, value: float) -> int:
    """ParticipantError for what is no whole number, but for rounding, or does not fit the variable's type."""
    low, high = find_range(variable.type) if variable.type in INTEGERS else (-EXACT, EXACT)
    if not low <= value <= high or abs(value - round(value)) > max(WHOLE, ROUNDED * abs(value)):
        raise ParticipantError(
            f"{end}.{variable.name} gets {value:.16g}: must be a whole number from {low} to {high}; change "
            "the factor of its connection"
        )
    return round(value)
