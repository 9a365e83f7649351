"""The values that an SSP's parameter bindings give to variables of its components."""

from __future__ import annotations

import logging
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any

from ...participants.description import BINARY, STRING, Unit
from .. import ScenarioError
from .names import VALUES_TYPE, expand_tag
from .structure import (
    Files,
    Path,
    Port,
    Structure,
    parse_xml,
    read_enumerations,
    read_transformation,
    read_units,
    resolve_source,
)
from .tables import find_table, look_up

Number = float | bool | str
_log = logging.getLogger("tribocosim")


@dataclass(frozen=True)
class StatedValue:
    """A value: a number, a truth value or an enumeration's item (`items` gives their numbers), in `unit` if
    that is stated; `factor` and `offset` come after its conversion. Or a `plain` text."""

    value: Number
    unit: str = ""
    units: dict[str, Unit] | None = None
    items: dict[str, int] | None = None
    factor: float | None = None
    offset: float | None = None
    suppressed: bool = False
    plain: bool = False


Values = dict[Path, dict[str, StatedValue]]


def read_values(found: Structure, files: Files, where: str, ignored: str) -> Values:
    """By component and variable. Outer bindings are stronger than inner ones, later than earlier; those are
    `ignored` whose file ends so."""
    values: Values = {}
    for path, binding in found.bindings:
        if ignored and binding.get("source", "").endswith(ignored):
            continue
        shown = f"{where}: {'.'.join(path) or 'the system'}"
        for name, stated in _read_binding(binding, found, files, shown):
            for component, variable in _find_targets(found, path, binding.get("prefix", "") + name, shown):
                values.setdefault(component, {})[variable] = stated
    return values


def _read_binding(
    binding: Any, found: Structure, files: Files, where: str
) -> Iterator[tuple[str, StatedValue]]:
    kind, source = binding.get("type", VALUES_TYPE), binding.get("source")
    if kind != VALUES_TYPE:
        raise ScenarioError(f"{where}: parameters of type {kind}; give a parameter set (SSV)")
    if source:
        root = parse_xml(_read_file(binding, source, files, where), f"{where}: {source}")
    else:
        root = binding.find(f"{expand_tag('ssd:ParameterValues')}/{expand_tag('ssv:ParameterSet')}")
    if root is None:
        return
    stated = dict(_read_set(root, found, where))
    mapping = binding.find(expand_tag("ssd:ParameterMapping"))
    if mapping is None:
        yield from stated.items()
        return
    if mapping.get("source"):
        entries = parse_xml(_read_file(mapping, mapping.get("source"), files, where), where)
    else:
        entries = mapping.find(expand_tag("ssm:ParameterMapping"))
    listed = () if entries is None else entries.findall(expand_tag("ssm:MappingEntry"))
    for name in dict.fromkeys(entry.get("source") for entry in listed):
        if name not in stated:
            _log.warning("%s: the mapping's source %r is no parameter of the set: left out", where, name)
    for entry in listed:
        name = entry.get("source")
        if name not in stated:
            continue
        suppressed = entry.get("suppressUnitConversion") in ("true", "1")
        if table := find_table(entry):
            value = look_up(*table, stated[name].value, f"{where}: {name}")
            yield entry.get("target"), replace(stated[name], value=value, suppressed=suppressed)
            continue
        factor, offset = read_transformation(entry, f"{where}: {name}")
        changed = replace(stated[name], factor=factor, offset=offset, suppressed=suppressed)
        yield entry.get("target"), changed


def _read_file(element: Any, source: str, files: Files, where: str) -> bytes:
    if element.get("sourceBase", "SSD") != "SSD":
        raise ScenarioError(f"{where}: {source}: sourceBase 'component'; put the file into resources/")
    return files(resolve_source(source, where))


def _read_set(root: Any, found: Structure, where: str) -> Iterator[tuple[str, StatedValue]]:
    units = found.units | read_units(root)
    bracketed = dict.fromkeys(
        unit for one in root.iter() if _is_bracketed(unit := one.get("unit") or "", units)
    )
    for unit in bracketed:
        _log.warning("%s: the unit %s is taken as %s", where, unit, unit[1:-1])
    enumerations = found.enumerations | read_enumerations(root)
    for parameter in root.iter(expand_tag("ssv:Parameter")):
        name = parameter.get("name")
        for child in parameter:
            kind, text = child.tag.rpartition("}")[2], child.get("value")
            if kind == "Real":
                unit = child.get("unit") or ""
                yield name, StatedValue(float(text), unit[1:-1] if unit in bracketed else unit, units)
            elif kind == "Integer":
                yield name, StatedValue(float(int(text)))
            elif kind == "Boolean":
                yield name, StatedValue(text in ("true", "1"))
            elif kind == "Enumeration":
                yield name, StatedValue(text, items=enumerations.get(child.get("name") or name))
            elif kind in (STRING, BINARY):
                yield name, StatedValue(text, plain=True)


def _is_bracketed(unit: str, units: dict[str, Unit]) -> bool:
    """Whether it is a unit that a tool wrote in brackets, which the standard does not have."""
    return unit[:1] == "[" and unit[-1:] == "]" and unit not in units


def _find_targets(found: Structure, path: Path, name: str, where: str) -> Iterator[tuple[Path, str]]:
    """The components' variables that `name` at the element of this path means."""
    if path in found.components:
        yield path, name
        return
    port = Port(path, name)
    if port in found.kinds:
        for target, edge in found.edges.items():
            if edge.source == port:
                if edge.factor is not None or edge.offset is not None:
                    raise ScenarioError(
                        f"{where}: {name} goes on with a transformation; transform its value instead"
                    )
                yield from _find_targets(found, target.path, target.connector, where)
        return
    element, dot, rest = name.partition(".")
    child = (*path, element)
    known = [*found.components, *(port.path for port in found.kinds)]
    if not dot:
        raise ScenarioError(f"{where}: no parameter {name!r}; name a connector, or ELEMENT.PARAMETER")
    if not any(other[: len(child)] == child for other in known):
        # Sets are often shared between packages of different parts.
        _log.warning("%s: the value of %r is of no element of this package: left out", where, name)
        return
    yield from _find_targets(found, child, rest, where)
