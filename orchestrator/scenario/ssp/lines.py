"""The connections of an SSP between its components, as lines of a scenario."""

import logging
from collections.abc import Iterator, Mapping
from typing import Any

from models.core.component import Component
from models.core.system import suggestion

from ...participants.description import INTEGERS
from ...participants.third_party import ThirdPartyComponent
from .. import Line, ScenarioError
from ..conversion import explain_differences, find_unit, get_units
from ..side_lines import list_side_variables
from .structure import Path as Place
from .structure import Port, Structure, trace_back
from .values import Conversion, follow

_log = logging.getLogger("tribocosim")


def build_lines(
    found: Structure, parts: Mapping[Place, Component], names: Mapping[Place, str], where: str
) -> list[Line]:
    """The connections between components, through whatever systems they pass."""
    lines = []
    for target in _list_targets(found, parts):
        side = target.connector in list_side_variables(parts[target.path], "input")
        if not side and target.connector not in parts[target.path].inputs:
            _check_parameter(found, target, where)
            continue
        steps = list(trace_back(found, target))[::-1]
        source = steps[0][1].source
        if source.path not in parts:
            continue  # an input of the whole, which nothing drives here
        outputs = parts[source.path].outputs.names
        sides = list_side_variables(parts[source.path], "output")
        if source.connector not in (*outputs, *sides):
            raise ScenarioError(
                f"{where}: the connection from {source} to {target}: {names[source.path]} has no output "
                f"{source.connector!r}; {suggestion(source.connector, outputs)}"
            )
        ends = f"{names[source.path]}.{source.connector}", f"{names[target.path]}.{target.connector}"
        plain = side or source.connector in sides
        if plain:
            lines.append(Line(*ends))
            continue
        line = _build_line(found, parts, steps, ends, where)
        if line.factor is None and (types := _find_types(parts, source, target)):
            _log.warning("%s: %s: the number goes as it is, from %s to %s", where, line, *types)
            line = Line(*ends, 1.0)
        lines.append(line)
    return lines


def _find_types(parts: Mapping[Place, Component], *ports: Port) -> list[str]:
    """The types of whole numbers and enumerations at both ends of a connection, if they differ."""
    ends = [(parts[port.path], port.connector) for port in ports]
    types = [part.about.variables[name].type for part, name in ends if isinstance(part, ThirdPartyComponent)]
    return types if len(set(types) & set(INTEGERS)) == len(ends) else []


def _check_parameter(found: Structure, target: Port, where: str) -> None:
    """ScenarioError where a component's parameter would have to follow another's variable."""
    *_, (_, edge) = trace_back(found, target)
    if edge.source.path in found.components:
        raise ScenarioError(
            f"{where}: {edge.source} goes to {target}, which is no input; only inputs are connected here, "
            "give it as a value"
        )


def _list_targets(found: Structure, parts: Mapping[Place, Component]) -> Iterator[Port]:
    """The connectors of components at which connections end; of an array its elements, each once."""
    for target in found.edges:
        if target.path not in parts:
            continue
        component = parts[target.path]
        inputs = [*component.inputs.variables, *list_side_variables(component, "input")]
        elements = [Port(target.path, name) for name in inputs if Port(target.path, name).array == target]
        if twice := [element for element in elements if element in found.edges]:
            raise ScenarioError(f"{twice[0]} has two sources, one of {target}; keep one")
        yield from elements if target.connector not in inputs and elements else [target]


def _build_line(
    found: Structure,
    parts: Mapping[Place, Component],
    steps: list[tuple[Port, Any]],
    ends: tuple[str, str],
    where: str,
) -> Line:
    """The connections `steps`, one after the other, as one."""
    source, target = parts[steps[0][1].source.path], parts[steps[-1][0].path]
    given = source.outputs.field(steps[0][1].source.connector).quantity
    wanted = target.inputs.field(steps[-1][0].connector).quantity
    units = {**get_units(source), **get_units(target), **found.units}
    unit = found.get_unit(steps[0][1].source) or given.unit
    # Of an FMU's unit that nobody defines, the connector knows what it is.
    first = given.unit if find_unit(given.unit, units) else unit
    way = [Conversion(unit)]
    for port, edge in steps:
        unit = found.get_unit(port) or (wanted.unit if port == steps[-1][0] else unit)
        way.append(Conversion(unit, edge.factor, edge.offset, edge.suppressed))
    way.append(Conversion(wanted.unit if find_unit(wanted.unit, units) else unit))
    if {step.into for step in way} <= {given.unit, wanted.unit} and all(
        step.factor is step.offset is None and not step.suppressed for step in way
    ):
        return Line(*ends)  # whose units the scenario converts
    try:
        linear = follow(way, first, units, units, given.relative and wanted.relative)
        plain = follow(way, first, units, units, relative=True)
    except ValueError as error:
        raise ScenarioError(f"{where}: {' -> '.join(ends)}: {error}; correct it") from None
    if linear != plain and given.relative != wanted.relative:
        raise ScenarioError(f"{where}: {explain_differences(*ends, given.relative)}")
    return Line(*ends, linear.factor, linear.offset or None)
