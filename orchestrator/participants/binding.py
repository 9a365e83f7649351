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
from .fmi_instance import ArrayLayout, Fail, FmiInstance, Transfer

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
        self.count = len(found := list(variables))
        given = {known[name].memory: value for name, value in (fixed or {}).items()}
        doubles = [(i, v) for i, v in enumerate(found) if v.type in fmi.real_types]
        # Where the doubles of each reference begin in the memory.
        first: dict[int, int] = {}
        rest: list[float] = []
        for _, v in doubles:
            if v.reference not in first:
                first[v.reference] = len(rest)
                rest += [_get_rest(one, given) for one in find_array(known, v)]
        self.references = np.array(list(first), dtype=np.uintc)
        self.rest = np.array(rest, dtype=float)
        self.fast = np.array([i for i, _ in doubles], dtype=np.int64)
        self.places = np.array([first[v.reference] + v.place for _, v in doubles], dtype=np.int64)
        self.plain = len(doubles) == len(first) == len(rest) == self.count
        # Other types: all elements of the variables of one type, their values at rest, and which go where.
        self.slow: dict[str, tuple[list[Variable], list[float], list[tuple[int, int]]]] = {}
        begins: dict[tuple[int, str], int] = {}
        for i, v in enumerate(found):
            if v.type not in fmi.real_types:
                whole, values, wanted = self.slow.setdefault(v.type, ([], [], []))
                key = (v.reference, v.type)
                if key not in begins:
                    begins[key] = len(whole)
                    array = find_array(known, v)
                    whole += array
                    values += [_get_rest(one, given) for one in array]
                wanted.append((i, begins[key] + v.place))

    def bind_set(self, fail: Fail, memory: Vector | None = None) -> None:
        """Prepare to set them; `memory` holds their values if they are plain."""
        self._bind(self.fmi.bind_setter, fail, memory, self._set_slow)

    def bind_get(self, fail: Fail, memory: Vector | None = None) -> None:
        """Prepare to get them, as `bind_set`."""
        self._getters = [
            self._bind_slow(kind, whole, wanted, fail) for kind, (whole, _, wanted) in self.slow.items()
        ]
        self._bind(self.fmi.bind_getter, fail, memory, self._get_slow)

    def _bind(
        self,
        bind: Callable[..., Transfer],
        fail: Fail,
        memory: Vector | None,
        slow: Callable[[Vector], None],
    ) -> None:
        self._memory = self.rest.copy() if memory is None else memory
        self._values = np.zeros(self.count)
        self._transfer_fast, self._transfer_slow = bind(self.references, self._memory, fail), slow
        # The FMU's function itself where that transfers all: it runs in every step.
        self.transfer = self._transfer_all if self.slow else self._transfer_fast

    def _transfer_all(self) -> None:
        self._transfer_fast()
        self._transfer_slow(self._values)

    def set_values(self, values: Vector) -> None:
        self._memory[self.places] = values[self.fast]
        if self.slow:
            self._values[:] = values
        self.transfer()

    def get_values(self) -> Vector:
        """Their values, in memory that the next call uses again."""
        self.transfer()
        self._values[self.fast] = self._memory[self.places]
        return self._values

    def _set_slow(self, values: Vector) -> None:
        for whole, rest, wanted in self.slow.values():
            own = rest.copy()
            for i, place in wanted:
                own[place] = (
                    values[i] if whole[0].type in REALS else self._make_whole(whole[place], values[i])
                )
            self.fmi.set(whole, own)

    def _bind_slow(
        self, kind: str, whole: list[Variable], wanted: list[tuple[int, int]], fail: Fail
    ) -> tuple[Transfer, Any, list[int], list[int]]:
        """How to get variables of that type: the call, its memory, where values go to, and where they are."""
        layout = ArrayLayout(whole)
        references = np.array(layout.references, dtype=np.uintc)
        memory, get = self.fmi.bind_typed_getter(kind, references, layout.size, fail)
        return get, memory, [i for i, _ in wanted], [layout.places[place] for _, place in wanted]

    def _get_slow(self, values: Vector) -> None:
        for get, memory, targets, places in self._getters:
            get()
            values[targets] = memory[places]


def _to_whole(end: str, variable: Variable, value: float) -> int:
    """ParticipantError for what is no whole number, but for rounding, or does not fit the variable's type."""
    low, high = find_range(variable.type) if variable.type in INTEGERS else (-EXACT, EXACT)
    if not low <= value <= high or abs(value - round(value)) > max(WHOLE, ROUNDED * abs(value)):
        raise ParticipantError(
            f"{end}.{variable.name} gets {value:.16g}: must be a whole number from {low} to {high}; change "
            "the factor of its connection"
        )
    return round(value)


def _get_rest(variable: Variable, given: Mapping[Any, float]) -> float:
    return given.get(variable.memory, variable.start or 0.0)
