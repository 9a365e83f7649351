"""Values of parameters, start values and inputs, in scenarios and in models."""

import difflib
import functools
import inspect
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from models.catalogue import CATALOGUE, describe_failure, find_factory, is_own
from models.core.component import Component
from models.core.kernel_check import check_kernels
from models.core.quantities import Condition, Layout, Quantity
from models.core.system import ModelError, suggestion

from ..errors import Fault, MistakeError, list_faults, one_of
from .units import UnitError, is_bare, to_unit


class Faults(MistakeError):
    """Faults of a table, or pairs of a key ("" is the table) and a text."""

    def __init__(self, *faults: Fault | tuple[str, str]) -> None:
        self.faults = [one if isinstance(one, Fault) else Fault.parse(*one) for one in faults]
        super().__init__(list_faults(self.faults))


class WithUnit(float):
    """A number that the scenario states with its unit."""


# A choice's name, a boolean, or a number in the quantity's unit.
Value = bool | float | str

# The tables of a component's values.
SECTIONS = "parameters", "start", "inputs"


def list_layouts(component: Component) -> dict[str, Layout]:
    """The variables of each of `SECTIONS`."""
    layouts = component.parameters, component.state, component.inputs
    return dict(zip(SECTIONS, layouts, strict=True))


def find_idle(component: Component, parameters: Any, section: str = "start") -> dict[str, Condition]:
    """The states, or parameters, whose values have no effect with these parameters, and the condition that
    fails."""
    found, given = {}, parameters if isinstance(parameters, Mapping) else {}
    for field_ in list_layouts(component)[section].fields:
        rule = field_.quantity.only
        deciding = [name for name in rule.parameters if name in component.parameters] if rule else []
        fields = map(component.parameters.field, deciding)
        defaults = {one.name: to_value(one.quantity, one.start) for one in fields}
        if rule and deciding and not any(map(rule.admits, ({**defaults, **given}[n] for n in deciding))):
            found[field_.name] = rule
    return found


def list_names(component: Component, parameters: Any, table: str = "{}") -> dict[str, Sequence[str]]:
    """The names that each of `SECTIONS` knows, as `table` writes it. A state without effect is named where
    what counts instead stands."""
    idle = find_idle(component, parameters)
    found: dict[str, Sequence[str]] = {
        table.format(section): [name for name in layout.variables if section != "start" or name not in idle]
        for section, layout in list_layouts(component).items()
    }
    for name, rule in idle.items():
        section, _, other = rule.instead.partition(".")
        found[f"{table.format(section)}, as {other}"] = [name]
    return found


# Begins a note that says what may be wrong with the input; a run repeats it beside its verdict.
WARNING = "warning: "


@dataclass(frozen=True)
class Inserted:
    """What a key of a component's table becomes.

    Parameters that the table states itself are stronger, but for those `replaced`, with their elements: a
    scenario that is extended may have them.
    """

    parameters: Mapping[str, Any]
    structure: Mapping[str, int] = field(default_factory=dict)
    notes: Sequence[str] = ()
    replaced: Collection[str] = ()

    def into(self, table: Mapping[str, Any]) -> dict[str, Any]:
        """The table with it."""
        given = table.get("parameters", {}).items()
        own = {name: value for name, value in given if name.partition("[")[0] not in self.replaced}
        made = {**table, "parameters": {**self.parameters, **own}}
        if self.structure:
            made["structure"] = {**table.get("structure", {}), **self.structure}
        return made


# Similarity of a name to one that another table knows, from which it is taken for it.
ALIKE = 0.8


@functools.cache
def build_component(name: str, structure: tuple[tuple[str, int], ...] = ()) -> Component:
    """The catalogue's component with these sizes; built once, so that its kernels are compiled once.

    ValueError for an unknown component or size, and for a size that the component refuses.
    """
    if name not in CATALOGUE and not is_own(name):
        raise ValueError(
            f"no component {name!r}; {suggestion(name, CATALOGUE)} (or your own as module:factory)"
        )
    factory = find_factory(name)
    try:
        known = tuple(inspect.signature(factory).parameters)
    except (ValueError, TypeError) as error:
        raise ValueError(f"{name}: {error}; must be a function that gives a Component") from None
    for key, _ in structure:
        if key not in known:
            sizes = suggestion(key, known) if known else "it has no structural sizes"
            raise ValueError(f"{name} has no size {key!r}; {sizes}")
    try:
        component = factory(**dict(structure))
    except ValueError:
        raise
    except Exception as error:
        if not is_own(name):
            raise
        raise ValueError(f"{name}: fails with {describe_failure(error)}") from None
    if not isinstance(component, Component):
        raise ValueError(
            f"{name}: gives a {type(component).__name__}, must be a models.core.component.Component"
        )
    if is_own(name):
        try:
            check_kernels(component)
        except ModelError as error:
            raise ValueError(f"{name}: {error}") from None
    return component


def parse_value(quantity: Quantity, value: Any) -> Value:
    """Convert to a choice's name, a boolean, or a number in `quantity.unit`.

    ValueError without the variable's name, which the caller adds.
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
            usual = quantity.plausible.units[0][0] if quantity.plausible else ""
            made = to_unit(value, quantity.unit, quantity.relative, quantity.display_unit or usual)
        except UnitError as error:
            raise ValueError(str(error)) from None
        return made if is_bare(value) else WithUnit(made)
    return value if isinstance(value, WithUnit) else float(value)


def to_number(quantity: Quantity, value: Value) -> float:
    """The number of a value that `parse_value` returned."""
    return float(quantity.choices.index(value)) if isinstance(value, str) else float(value)


def to_value(quantity: Quantity, stored: float) -> Value:
    """The inverse of `to_number`."""
    if quantity.choices:
        return quantity.choices[int(stored)]
    return bool(stored) if quantity.boolean else float(stored)


def find_place(name: str, tables: Mapping[str, Sequence[str]], near: str) -> str:
    """The remedy for a name that is not known where it stands, by the names that other tables know; `near` is
    what can be said of its own."""
    if places := [table for table, names in tables.items() if name in names]:
        return f"it belongs in {' or '.join(places)}"
    if near.startswith("did you mean"):
        return near
    start = f"{name}_start"  # of a state, as our FMUs name it
    if places := [table for table, names in tables.items() if start in names]:
        return f"did you mean {start}, in {' or '.join(places)}?"
    close = {table: difflib.get_close_matches(name[:100], names, 1, ALIKE) for table, names in tables.items()}
    return next((f"did you mean {found[0]}, in {table}?" for table, found in close.items() if found), near)


def parse_values(
    layout: Layout, values: Mapping[str, Any], kind: str, others: Mapping[str, Sequence[str]] | None = None
) -> dict[str, Value]:
    """Parse all values, and add those that follow another one (`Quantity.same_as`); raises Faults.

    `others` are the names that other tables know, for remedies."""
    found: dict[str, Value] = {}
    faults: list[tuple[str, str]] = []
    for name, value in values.items():
        if name not in layout:
            known = {one: layout.field(one).quantity.description for one in layout.variables}
            near = suggestion(name, known, known) if known else "leave it out"
            remedy = find_place(name, others or {}, near)
            faults.append((name, f": no such {kind}; {remedy}"))
            continue
        quantity = layout.field(name).quantity
        if quantity.internal:
            faults.append((name, f": the component sets this {kind} itself; leave it out"))
            continue
        try:
            found[name] = parse_value(quantity, value)
        except ValueError as error:
            shown = f" = {value!r}" if not isinstance(value, str) or quantity.choices else ""
            faults.append((name, f"{shown} ({quantity.description}): {error}"))
    if faults:  # with what later checks would find
        raise Faults(*faults, *_find_more(layout, found))
    same_as = {field.name: field.quantity.same_as for field in layout.fields if field.quantity.same_as}
    return {name: found[other] for name, other in same_as.items() if other in found} | found


def _find_more(layout: Layout, values: Mapping[str, Value]) -> Iterator[Fault]:
    """The faults of values that could be read: out of range, or without their unit."""
    for name, value in values.items():
        quantity = layout.field(name).quantity
        if isinstance(value, str):
            continue
        if said := quantity.fault(name, float(value)):
            yield Fault(name, said.removeprefix(name))
        elif (doubt := doubt_value(name, quantity, value)) and doubt.remedy:
            yield doubt


def doubt_value(place: str, quantity: Quantity, value: bool | float) -> Fault | None:
    """A number that is not plausible; with a remedy where it is stated without a unit and another unit makes
    it plausible."""
    if not (doubt := quantity.doubt(float(value))):
        return None
    written = f"{value:g} {quantity.unit}"
    said, _, meant = doubt.partition("; ")
    bare = meant and not isinstance(value, WithUnit)
    remedy = f"{meant} Write the unit, even if {written} is meant" if bare else ""
    return Fault(place, f" = {written} ({quantity.description}): {said}", remedy)


def to_numbers(layout: Layout, values: Mapping[str, Value]) -> dict[str, float]:
    """The numbers of values that `parse_values` returned; strings of third-party FMUs are left out."""
    return {
        name: to_number(layout.field(name).quantity, value)
        for name, value in values.items()
        if name in layout
    }
