"""Values of parameters, starts and inputs: what a scenario writes, what it means, and back."""

from __future__ import annotations

import functools
import inspect
from collections.abc import Mapping
from typing import Any

from models.catalogue import CATALOGUE
from models.core.component import Component
from models.core.quantities import Layout, Quantity
from models.core.system import suggestion

from ..errors import one_of
from .units import UnitError, is_bare, to_unit


class Faults(ValueError):
    """Faults of a table: pairs of a key ("": the table itself) and the message that follows it."""

    def __init__(self, *faults: tuple[str, str]) -> None:
        super().__init__("; ".join(key + message for key, message in faults))
        self.faults = faults


class WithUnit(float):
    """A number that was written with its unit."""


# A choice by name, a truth value, or a number in the quantity's unit.
Value = bool | float | str


@functools.cache
def build_component(name: str, structure: tuple[tuple[str, int], ...] = ()) -> Component:
    """The catalogue's component with these sizes, made once (its kernels are compiled once then).

    ValueError for an unknown component, an unknown size, or one that the component refuses.
    """
    if name not in CATALOGUE:
        raise ValueError(f"no component {name!r}; {suggestion(name, CATALOGUE)}")
    known = tuple(inspect.signature(CATALOGUE[name]).parameters)
    for key, _ in structure:
        if key not in known:
            sizes = suggestion(key, known) if known else "it has no structural sizes"
            raise ValueError(f"{name} has no size {key!r}; {sizes}")
    return CATALOGUE[name](**dict(structure))


def parse_value(quantity: Quantity, value: Any) -> Value:
    """`value` as it is kept: a choice's name, true or false, a number in `quantity.unit`.

    ValueError without the variable's name, which the caller knows.
    """
    if quantity.choices:
        if value in quantity.choices:
            return str(value)
        raise ValueError(one_of(quantity.choices, value))
    if quantity.boolean:
        if isinstance(value, bool) or value in (0.0, 1.0):
            return bool(value)
        raise ValueError("must be true or false")
    if isinstance(value, bool):
        raise ValueError("must be a number, not true or false")
    if isinstance(value, str):
        try:
            made = to_unit(value, quantity.unit)
        except UnitError as error:
            raise ValueError(str(error)) from None
        return made if is_bare(value) else WithUnit(made)
    return value if isinstance(value, WithUnit) else float(value)


def to_number(quantity: Quantity, value: Value) -> float:
    """The number behind a value that `meaning` returned."""
    return float(quantity.choices.index(value)) if isinstance(value, str) else float(value)


def to_value(quantity: Quantity, stored: float) -> Value:
    """The inverse of `number`."""
    if quantity.choices:
        return quantity.choices[int(stored)]
    return bool(stored) if quantity.boolean else float(stored)


def parse_values(
    layout: Layout, values: Mapping[str, Any], kind: str, others: Mapping[str, Layout] | None = None
) -> dict[str, Value]:
    """`meaning` of every value, and of those that follow another one (`Quantity.same_as`); raises Faults.

    `others` are the layouts of other tables, where a name that is not known here may belong."""
    found: dict[str, Value] = {}
    faults: list[tuple[str, str]] = []
    for name, value in values.items():
        if name not in layout:
            tables = [table for table, other in (others or {}).items() if name in other.variables]
            if tables:
                remedy = f"give it in {' or '.join(tables)}, where there is one of this name"
            else:
                remedy = suggestion(name, layout.variables) if layout.variables else "leave it out"
            faults.append((name, f": no such {kind}; {remedy}"))
            continue
        quantity = layout.field(name).quantity
        if quantity.internal:
            faults.append(
                (name, f": the {kind} is the component's own; it starts as that lets it, leave it out")
            )
            continue
        try:
            found[name] = parse_value(quantity, value)
        except ValueError as error:
            shown = f" = {value!r}" if not isinstance(value, str) or quantity.choices else ""
            faults.append((name, f"{shown} ({quantity.description}): {error}"))
    if faults:
        raise Faults(*faults)
    same_as = {field.name: field.quantity.same_as for field in layout.fields if field.quantity.same_as}
    return {name: found[other] for name, other in same_as.items() if other in found} | found


def to_numbers(layout: Layout, values: Mapping[str, Value]) -> dict[str, float]:
    """What `models` wants of values that `meanings` returned, without those that are only texts."""
    return {
        name: to_number(layout.field(name).quantity, value)
        for name, value in values.items()
        if name in layout
    }
