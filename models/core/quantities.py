"""Physical quantities: the metadata of every parameter, state, input and output, and their layout.

A *record* is a dataclass whose fields have a `Quantity`: `mass: float = Quantity(...).default(1.0)`, or that
of their annotation where several share a type, `Mass = Annotated[float, Quantity(...)]`. A `Layout` turns a
record type into a flat vector of doubles and back; compiled kernels see the same memory as a structured
record (`record_of(x, layout.dtype).velocity`), integrators and FMI see the vector.
"""

from __future__ import annotations

import copy
import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import MISSING, dataclass, field, fields, make_dataclass, replace
from typing import Annotated, Any, TypedDict, get_args, get_origin, get_type_hints

import numpy as np
from numpy.typing import NDArray

Vector = NDArray[np.float64]

# Taylor coefficients that an input may have: value and three derivatives (cubic).
INPUT_COEFFICIENTS = 4


@dataclass(frozen=True)
class Plausible:
    """Magnitudes that occur in practice, from `low` to `high` in the quantity's unit, and the reason.

    `units` are others in which people write such values, each with what it is in the quantity's unit. Zero is
    plausible: it is the same in every unit.
    """

    low: float
    high: float
    units: tuple[tuple[str, float], ...]
    reason: str

    def holds(self, value: float) -> bool:
        return value == 0.0 or self.low <= abs(value) <= self.high

    def reading(self, number: float) -> str:
        """The number with the unit in which it is plausible, e.g. "45 N/mm"; "" if there is none."""
        return next((f"{number:g} {unit}" for unit, size in self.units if self.holds(number * size)), "")


@dataclass(frozen=True)
class Condition:
    """A value has an effect only where one of `parameters` is among the `choices`, or is not zero where there
    are none; a component without any of them has no such condition. Elsewhere `instead` has it, as
    "parameters.NAME"."""

    parameters: tuple[str, ...]
    choices: tuple[bool | str, ...] = ()
    instead: str = ""

    def admits(self, value: bool | float | str) -> bool:
        """Whether a parameter of this value lets the other have an effect."""
        return value in self.choices if self.choices else bool(value)


@dataclass(frozen=True)
class Quantity:
    """What a number means: unit (SI symbols), description, nominal size and allowed range.

    `positive` excludes zero, which `minimum` alone cannot. `choices` makes the number an index into names,
    `boolean` a truth value, `count` a whole number; `relative` makes it a difference, whose unit has no
    offset; a `stepwise` one changes at events only. `size` names the structural size of a vector-valued
    field. An `internal` state is evolving data as any other, saved and restored with it, but no variable:
    it begins as its component lets it and is not set, shown or brought to rest from outside. A state that
    `accumulates` is a sum over time on which no motion depends: steady cycles begin it anew. `same_as`
    names the parameter whose value a scenario takes where this one is not given. A value outside the
    `plausible` magnitudes is allowed, but probably a slip of the unit. A parameter or start
    value may count `only` on a condition.
    """

    unit: str
    description: str = ""
    nominal: float = 1.0
    minimum: float = -math.inf
    maximum: float = math.inf
    positive: bool = False
    display_unit: str = ""
    choices: tuple[str, ...] = ()
    boolean: bool = False
    count: bool = False
    relative: bool = False
    stepwise: bool = False
    size: str = ""
    internal: bool = False
    accumulates: bool = False
    same_as: str = ""
    plausible: Plausible | None = None
    only: Condition | None = None

    def of(self, description: str, **changes: Any) -> Quantity:
        """A quantity of this kind, with a description and, where it differs, other fields."""
        return replace(self, description=description, **changes)

    def __call__(self, description: str, value: float = 0.0, **changes: Any) -> float:
        """A record's field of such a quantity, as `default` makes it."""
        return self.of(description, **changes).default(value)

    def each(self, description: str, size: str, start: float = 0.0, **changes: Any) -> Vector:
        """A vector-valued field of such a quantity, as `per_element` makes it."""
        return self.of(description, size=size, **changes).per_element(start)

    @property
    def jumps(self) -> bool:
        """True for what has no values in between, or changes at events only."""
        return self.stepwise or self.discrete

    def default(self, value: float = 0.0) -> float:
        """A record's field of this quantity with this value, which states begin with."""
        made: float = field(default=value, metadata={"quantity": self})
        return made

    def per_element(self, start: float = 0.0) -> Vector:
        """A vector-valued field of this quantity; every element begins with `start`."""
        made: Vector = field(default_factory=lambda: np.zeros(0), metadata={"quantity": self, "start": start})
        return made

    @property
    def discrete(self) -> bool:
        """True for truth values, counts and choices."""
        return self.boolean or self.count or bool(self.choices)

    def describe_range(self) -> str:
        """The allowed range in words."""
        if self.choices:
            return "one of " + ", ".join(self.choices)
        if self.boolean:
            return "true or false"
        shown = ".16g" if self.count else "g"
        low = "> 0" if self.positive else (f">= {self.minimum:{shown}}" if self.minimum > -math.inf else "")
        high = f"<= {self.maximum:{shown}}" if self.maximum < math.inf else ""
        ranged = " and ".join(part for part in (low, high) if part)
        return f"a whole number {ranged}".strip() if self.count else ranged or "any finite number"

    def fault(self, name: str, value: float) -> str | None:
        """A message naming the quantity, its value and the allowed range, or None if it is allowed."""
        whole = not self.discrete or float(value).is_integer()
        low, high = self.limits()
        inside = math.isfinite(value) and whole and low <= value <= high
        if inside and not (self.positive and value <= 0.0):
            return None
        if not math.isfinite(value):
            ranged = self.describe_range().replace("any finite number", "")
            ranged = f" and {ranged}" if ranged else ""
            return f"{name} = {value:g}{self._describe_unit()}: must be finite{ranged}"
        return f"{name} = {value:g}{self.requirement()}"

    def limits(self) -> tuple[float, float]:
        """Least and largest allowed value, also of truth values and choices."""
        low = max(self.minimum, 0.0) if (self.boolean or self.choices) else self.minimum
        return low, 1.0 if self.boolean else (len(self.choices) - 1.0 if self.choices else self.maximum)

    def displace(self, value: float) -> float:
        """Another allowed value, by the nominal size away; the same one where there is none."""
        low, high = self.limits()
        return next((m for m in (value + self.nominal, value - self.nominal) if low <= m <= high), value)

    def requirement(self) -> str:
        """What follows a value in a message: its unit, its meaning and the allowed range."""
        return f"{self._describe_unit()}: must be {self.describe_range()}"

    def doubt(self, value: float) -> str:
        """Why `value` is probably a slip of the unit, and what it may mean; "" if it is plausible."""
        if self.plausible is None or self.plausible.holds(value):
            return ""
        reading = self.plausible.reading(value)
        return self.plausible.reason + (f"; did you mean {reading}?" if reading else ".")

    def _describe_unit(self) -> str:
        unit = "" if self.unit == "1" else f" {self.unit}"
        return f"{unit} ({self.description})"


@dataclass(frozen=True)
class Field:
    """One scalar of a layout: its name (vectors are numbered from 1), quantity and start value."""

    name: str
    quantity: Quantity
    start: float

    def add_suffix(self, suffix: str) -> str:
        """The name with a suffix, which stands before an index: torque[2] and _der1 give torque_der1[2]."""
        stem, bracket, index = self.name.partition("[")
        return stem + suffix + bracket + index


class Layout:
    """The fields of a record type as a flat vector of doubles.

    `sizes` gives the structural sizes of vector fields, by the name their quantity states.
    """

    def __init__(self, record: type, sizes: Mapping[str, int] | None = None) -> None:
        self.record = record
        self.sizes = dict(sizes or {})
        hints = get_type_hints(record, include_extras=True)
        formats: list[tuple[str, str, tuple[int, ...]]] = []
        scalars: list[Field] = []
        for item in fields(record):
            quantity = _quantity_of(record, item, hints[item.name])
            start = float(item.metadata["start"] if item.default is MISSING else item.default)
            if quantity.size:
                count = self.sizes[quantity.size]
                formats.append((item.name, "f8", (count,)))
                scalars += [Field(f"{item.name}[{i + 1}]", quantity, start) for i in range(count)]
            else:
                formats.append((item.name, "f8", ()))
                scalars.append(Field(item.name, quantity, start))
        self._take(scalars, np.dtype((np.record, formats)))

    def _take(self, scalars: Sequence[Field], dtype: np.dtype[Any]) -> None:
        self.dtype = dtype
        self.fields = tuple(scalars)
        self.names = tuple(scalar.name for scalar in scalars)
        self.size = len(scalars)
        self.start: Vector = np.array([scalar.start for scalar in scalars], dtype=np.float64)
        self.nominal: Vector = np.array([scalar.quantity.nominal for scalar in scalars], dtype=np.float64)
        # The names of those that are variables: all but internal ones.
        self.variables = tuple(scalar.name for scalar in scalars if not scalar.quantity.internal)
        self._index = {name: i for i, name in enumerate(self.names)}
        quantities = [scalar.quantity for scalar in scalars]
        limits = np.array([one.limits() for one in quantities]).reshape(-1, 2)
        positive = np.array([one.positive for one in quantities], bool)
        self._low: Vector = np.where(positive, np.maximum(limits[:, 0], math.ulp(0.0)), limits[:, 0])
        self._high: Vector = limits[:, 1]
        self._discrete = np.array([one.discrete for one in quantities], bool)

    def __contains__(self, name: str) -> bool:
        return name in self._index

    def extend(self, quantities: Mapping[str, Quantity]) -> Layout:
        """A layout with these scalars after its own; they start at zero."""
        added = [
            (name, Annotated[float, quantity], field(default=0.0)) for name, quantity in quantities.items()
        ]
        return Layout(make_dataclass(self.record.__name__, added, bases=(self.record,)), self.sizes)

    def with_start(self, values: Mapping[str, float]) -> Layout:
        """The same layout with other start values in the places of these."""
        return self.with_fields(
            replace(field, start=float(values.get(field.name, field.start))) for field in self.fields
        )

    def with_fields(self, scalars: Iterable[Field]) -> Layout:
        """The same layout with these scalars in the places of its own."""
        made = copy.copy(self)
        made._take(tuple(scalars), self.dtype)
        return made

    def index(self, name: str) -> int:
        """Position of a scalar in the vector; KeyError with the known names if there is none."""
        try:
            return self._index[name]
        except KeyError:
            raise KeyError(f"{name!r} is not one of {', '.join(self.variables)}") from None

    def field(self, name: str) -> Field:
        """The field called `name`."""
        return self.fields[self.index(name)]

    def vector(self, values: Mapping[str, float] | None = None) -> Vector:
        """A vector of start values, with `values` put in their places."""
        vector = self.start.copy()
        for name, value in (values or {}).items():
            vector[self.index(name)] = float(value)
        return vector

    def named(self, vector: Vector) -> dict[str, float]:
        """The vector's elements by name."""
        return {name: float(value) for name, value in zip(self.names, vector, strict=True)}

    def view(self, vector: Vector) -> Any:
        """The record that shares the vector's memory; one without fields, of no memory."""
        return vector.view(self.dtype)[0] if self.size else np.zeros(1, self.dtype)[0]

    def defaults(self) -> Any:
        """The record of the start values."""
        return self.view(self.start.copy())

    def faults(self, vector: Vector) -> list[str]:
        """Messages for every element outside its allowed range."""
        inside = np.isfinite(vector) & (self._low <= vector) & (vector <= self._high)
        outside = np.flatnonzero(~inside | self._discrete & (np.trunc(vector) != vector))
        found = (self.fields[i].quantity.fault(self.names[i], float(vector[i])) for i in outside)
        return [message for message in found if message]


class Layouts(TypedDict):
    """The four records of a component."""

    parameters: Layout
    state: Layout
    inputs: Layout
    outputs: Layout


def layouts(
    parameters: type, state: type, inputs: type, outputs: type, sizes: Mapping[str, int] | None = None
) -> Layouts:
    """The records of a component: Component(..., **layouts(Parameters, State, Inputs, Outputs))."""
    return Layouts(
        parameters=Layout(parameters, sizes),
        state=Layout(state, sizes),
        inputs=Layout(inputs, sizes),
        outputs=Layout(outputs, sizes),
    )


def join(*records: type) -> type:
    """A record with the fields of all of these, those of the last first."""
    return make_dataclass(records[0].__name__, [], bases=records)


class FieldLayout(Layout):
    """A layout of given scalars, whose names need not be Python's."""

    def __init__(self, scalars: Iterable[Field], dtype: np.dtype[Any] | None = None) -> None:
        self.record, self.sizes = type(None), {}
        scalars = tuple(scalars)
        self._take(scalars, dtype or np.dtype((np.record, [(scalar.name, "f8") for scalar in scalars])))


def _quantity_of(record: type, item: Any, hint: Any) -> Quantity:
    notes = get_args(hint)[1:] if get_origin(hint) is Annotated else ()
    for note in (item.metadata.get("quantity"), *notes):
        if isinstance(note, Quantity):
            return note
    raise TypeError(f"{record.__name__}.{item.name} has no Quantity")
