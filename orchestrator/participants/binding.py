"""Scalars of an FMU bound to memory: what one call transfers, and what has to go variable by variable.

Doubles go in one call, arrays of FMI 3 whole; whole numbers, truth values and single precision go one
variable after the other.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping

import numpy as np

from models.core.quantities import Vector

from .description import REALS, Variable
from .fmi_instance import FmiInstance

Fail = Callable[[int], None]


def find_array(known: Mapping[str, Variable], variable: Variable) -> list[Variable]:
    """All elements of the variable's array, in their places; the variable itself if it is none."""
    if variable.size == 1:
        return [variable]
    key = (variable.reference, variable.type)
    found = {v.place: v for v in known.values() if (v.reference, v.type) == key}
    return [found[place] for place in range(variable.size)]


class Elements:
    """These scalars, in this order. `plain` where one call moves them as they are: no arrays, doubles only.

    Of an array that is set in part the other elements have the values in `fixed`, or their start values.
    """

    def __init__(
        self,
        fmi: FmiInstance,
        known: Mapping[str, Variable],
        variables: Iterable[Variable],
        fixed: Mapping[str, float] | None = None,
    ) -> None:
        self.fmi = fmi
        self.count = len(found := list(variables))
        doubles = [(i, v) for i, v in enumerate(found) if v.type in fmi.real_types]
        # Where the doubles of each reference begin in one memory.
        first: dict[int, int] = {}
        rest: list[float] = []
        for _, v in doubles:
            if v.reference not in first:
                first[v.reference] = len(rest)
                rest += [_get_rest(one, fixed) for one in find_array(known, v)]
        self.references = np.array(list(first), dtype=np.uintc)
        self.rest = np.array(rest, dtype=float)
        self.fast = np.array([i for i, _ in doubles], dtype=np.int64)
        self.places = np.array([first[v.reference] + v.place for _, v in doubles], dtype=np.int64)
        self.plain = len(doubles) == len(first) == len(rest) == self.count
        # The other variables: all elements of each, their values at rest, and which of them are wanted where.
        self.slow: dict[tuple[int, str], tuple[list[Variable], list[float], list[tuple[int, int]]]] = {}
        for i, v in enumerate(found):
            if v.type not in fmi.real_types:
                key = (v.reference, v.type)
                if key not in self.slow:
                    whole = find_array(known, v)
                    self.slow[key] = (whole, [_get_rest(one, fixed) for one in whole], [])
                self.slow[key][2].append((i, v.place))

    def setting(self, fail: Fail, memory: Vector | None = None) -> Bound:
        """To set them; `memory`, if they are plain, is where their values are."""
        return Bound(self, self.fmi.bind_setter, fail, memory, self._set_slow)

    def getting(self, fail: Fail, memory: Vector | None = None) -> Bound:
        """To get them, as `setting`."""
        return Bound(self, self.fmi.bind_getter, fail, memory, self._get_slow)

    def _set_slow(self, values: Vector) -> None:
        for whole, rest, wanted in self.slow.values():
            own = rest.copy()
            for i, place in wanted:
                own[place] = values[i] if whole[0].type in REALS else round(values[i])
            self.fmi.set(whole, own)

    def _get_slow(self, values: Vector) -> None:
        for whole, _, wanted in self.slow.values():
            found = self.fmi.get(whole)
            for i, place in wanted:
                values[i] = found[place]


def _get_rest(variable: Variable, fixed: Mapping[str, float] | None) -> float:
    return (fixed or {}).get(variable.name, variable.start or 0.0)


class Bound:
    """`Elements` with memory for their values."""

    def __init__(
        self,
        elements: Elements,
        transfer: Callable[..., Callable[[], None]],
        fail: Fail,
        memory: Vector | None,
        slow: Callable[[Vector], None],
    ) -> None:
        self._elements = e = elements
        self._memory = e.rest.copy() if memory is None else memory
        self._values = np.zeros(e.count)
        self._move = transfer(e.references, self._memory, fail)
        self._slow = slow
        self.plain = e.plain
        # What runs in every step is such a function itself where that will do.
        self.transfer = self._move if not e.slow else self._transfer

    def _transfer(self) -> None:
        self._move()
        self._slow(self._values)

    def give(self, values: Vector) -> None:
        """Set them to these."""
        e = self._elements
        self._memory[e.places] = values[e.fast]
        if e.slow:
            self._values[:] = values
        self.transfer()

    def values(self) -> Vector:
        """Get them; memory that is used again."""
        e = self._elements
        self.transfer()
        self._values[e.fast] = self._memory[e.places]
        return self._values
