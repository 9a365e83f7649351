"""Connections of what is no number: clocks, strings and binary values of third-party FMUs."""

from collections.abc import Iterable, Mapping
from typing import Any

from models.core.component import Component
from models.core.system import Connection, Port, suggestion

from ..engine.instants import SideLines
from ..participants.description import BINARY, BOOLEANS, CLOCK, INTEGERS, STRING, Description, Variable
from ..participants.description3 import TRIGGERED
from ..participants.third_party import ThirdPartyComponent
from . import ScenarioError
from .connection import Line

SIDE_TYPES = (STRING, BINARY, CLOCK)
# FMI 3.0's types of what FMI 1.0 and 2.0 call otherwise.
SAME_TYPES = {"Integer": "Int32"}


def is_side_line(line: Line, components: Mapping[str, Component]) -> bool:
    """Whether one of its ends is no number."""
    return any(v is not None and v.type in SIDE_TYPES for v in _find_ends(line, components))


def read_side_lines(lines: Iterable[Line], components: Mapping[str, Component]) -> SideLines:
    """Those among the lines that connect what is no number. ScenarioError where the ends do not fit."""
    found: dict[str, list[Connection]] = {STRING: [], BINARY: [], CLOCK: []}
    driven: set[str] = set()
    for line in lines:
        if not is_side_line(line, components):
            continue
        source, target = _find_ends(line, components)
        if fault := _find_fault(line, source, target, components):
            raise ScenarioError(f"{line}: {fault}")
        if line.target in driven:
            raise ScenarioError(f"{line}: the input {line.target} is connected twice; leave one out")
        assert source is not None
        driven.add(line.target)
        found[source.type].append(Connection(_to_port(line.source), _to_port(line.target)))
    return SideLines(tuple(found[CLOCK]), (*found[STRING], *found[BINARY]))


def list_side_variables(component: Component, causality: str) -> list[str]:
    """The variables of this causality that are no numbers."""
    if not isinstance(component, ThirdPartyComponent):
        return []
    known = component.about.variables.values()
    return [v.name for v in known if v.causality == causality and v.type in SIDE_TYPES]


def check_equal_types(line: Line, given: Component, wanted: Component) -> None:
    """ScenarioError where a whole number, enumeration or truth value goes to another type of such."""
    if not isinstance(given, ThirdPartyComponent) or not isinstance(wanted, ThirdPartyComponent):
        return
    source, target = (
        component.about.variables[end.split(".", 1)[1]]
        for component, end in ((given, line.source), (wanted, line.target))
    )
    if target.type not in (*INTEGERS, *BOOLEANS):
        return
    one, other = (SAME_TYPES.get(v.type, v.type) for v in (source, target))
    if one != other:
        raise ScenarioError(
            f"{line}: {_describe(source)} does not fit an input of type {target.type}; with a factor its "
            f"number goes as it is: {line.source} * 1 -> {line.target}"
        )
    if dict(source.items) != dict(target.items):
        raise ScenarioError(
            f"{line}: the enumerations differ: {_list_items(source)} -> {_list_items(target)}"
        )


def _find_ends(line: Line, components: Mapping[str, Component]) -> tuple[Variable | None, Variable | None]:
    """The variables at its ends; None for what is none of a third-party FMU."""

    def find(end: str) -> Variable | None:
        name, _, variable = end.partition(".")
        component = components.get(name)
        if not isinstance(component, ThirdPartyComponent):
            return None
        return component.about.variables.get(variable)

    return find(line.source), find(line.target)


def _find_fault(
    line: Line, source: Variable | None, target: Variable | None, components: Mapping[str, Component]
) -> str:
    """Why the line cannot be, with the remedy; empty if it can."""
    for end, wanted, variable in ((line.source, "output", source), (line.target, "input", target)):
        name, _, short = end.partition(".")
        component = components.get(name)
        if component is None:
            return f"no component {name!r}; {suggestion(name, components)}"
        if variable is None and isinstance(component, ThirdPartyComponent):
            return f"no variable {short!r}; {suggestion(short, component.about.variables)}"
        if variable is not None and variable.causality != wanted:
            return f"{end} is no {wanted}; connect an output to an input"
    if source is None or target is None or source.type != target.type:
        kinds = [_describe(v) if v else "a number of a component" for v in (source, target)]
        return f"{kinds[0]} does not fit {kinds[1]}: both ends must be of the same type"
    if line.factor is not None or line.offset is not None:
        return f"{_describe(source)} has no factor or offset; leave them out"
    if source.size > 1 or target.size > 1:
        return "elements of arrays of texts cannot be connected; leave it out"
    for end in (line.source, line.target):
        component = components[end.partition(".")[0]]
        assert isinstance(component, ThirdPartyComponent)
        if fault := _find_inability(component.about, end, source.type == CLOCK):
            return fault
    return ""


def _find_inability(about: Description, end: str, clock: bool) -> str:
    if about.integrated:
        return f"{end}: FMUs that are integrated here (model exchange) exchange numbers only"
    if not clock:
        return ""
    known: Any = about.events.clocks.get(end.split(".", 1)[1]) if about.events else None
    if known is None:
        return f"{end}: clocks need an FMU with event mode (hasEventMode)"
    if known.variability != TRIGGERED:
        return f"{end}: a clock of intervalVariability {known.variability} ticks by time; leave it out"
    return ""


def _describe(variable: Variable) -> str:
    return f"a value of type {variable.type}"


def _list_items(variable: Variable) -> str:
    return ", ".join(f"{name} = {number}" for name, number in variable.items) or "none"


def _to_port(end: str) -> Port:
    return Port(*end.split(".", 1))
