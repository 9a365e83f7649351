"""The values that an SSP's parameter bindings give to variables of its components."""

from __future__ import annotations

import logging
import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import product
from typing import Any, NamedTuple

from ...participants.description import BINARY, BOOLEANS, INTEGERS, REALS, STRING, Unit
from ...participants.wrapping import Linear
from .. import ScenarioError
from ..conversion import convert_units
from .names import VALUES_TYPE, expand_tag
from .structure import (
    Files,
    Path,
    Port,
    Structure,
    check_version,
    parse_xml,
    read_enumerations,
    read_transformation,
    read_units,
    resolve_source,
)
from .tables import find_table, look_up

Number = float | bool | str
SUPPRESSED = ("true", "1")
# Elements of a parameter that are no value.
ABOUT = ("Dimension", "Annotations", "MetaData", "Signature")
ENUMERATION = "Enumeration"
_log = logging.getLogger("tribocosim")


class Conversion(NamedTuple):
    """On a value's way: into a unit ("": that of the variable at the end), unless that is `suppressed`, and
    then by `factor` and `offset`."""

    into: str
    factor: float | None = None
    offset: float | None = None
    suppressed: bool = False


@dataclass(frozen=True)
class StatedValue:
    """A value: a number, a truth value or an enumeration's item (`items` gives their numbers), in `unit` if
    that is stated; `way` are its conversions. Or a `plain` text."""

    value: Number
    unit: str = ""
    units: dict[str, Unit] | None = None
    items: dict[str, int] | None = None
    way: tuple[Conversion, ...] = ()
    plain: bool = False

    def enter(self, unit: str | None) -> StatedValue:
        """At a connector with this unit, if it states one: what is not yet in a unit comes into it."""
        if not unit:
            return self
        *before, last = self.way or (Conversion(""),)
        added = () if last.into else (last._replace(into=unit),)
        return replace(self, way=(*before, *added) if added else self.way)

    def convert(self, number: float, unit: str, units: Mapping[str, Unit], relative: bool) -> float:
        """The number at the end of the way, in `unit`; ValueError where units do not fit."""
        known = {**(self.units or {}), **units}
        way = [step._replace(into=step.into or unit) for step in (*self.way, Conversion(""))]
        linear = follow(way, self.unit, {**known, **(self.units or {})}, known, relative)
        return linear.factor * number + linear.offset


def follow(
    way: Sequence[Conversion],
    here: str,
    given: Mapping[str, Unit],
    units: Mapping[str, Unit],
    relative: bool = False,
) -> Linear:
    """What a number in the unit `here` becomes on its way; ValueError where units do not fit. `given` are the
    units of where it comes from."""
    made = Linear()
    for step in way:
        if here and step.into and here != step.into and not step.suppressed:
            linear = convert_units(here, given, step.into, units, relative)
            if linear is None:
                raise ValueError(f"unit {here} does not fit {step.into or 'a plain number'}")
            made = _chain(made, linear)
        made = _chain(made, Linear(1.0 if step.factor is None else step.factor, step.offset or 0.0))
        here = step.into or here
    return made


def _chain(first: Linear, second: Linear) -> Linear:
    return Linear(second.factor * first.factor, second.factor * first.offset + second.offset)


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
            full = binding.get("prefix", "") + name
            for component, variable, arrived in _find_targets(found, path, full, stated, shown):
                values.setdefault(component, {})[variable] = arrived
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
    check_version(root, f"{where}: {source or 'its values'}")
    stated: dict[str, StatedValue] = {}
    for name, value in _read_set(root, found, where):
        if stated.setdefault(name, value) is not value:
            raise ScenarioError(f"{where}: {name} has two values in one set; leave one out")
    mapping = binding.find(expand_tag("ssd:ParameterMapping"))
    if mapping is None:
        yield from stated.items()
        return
    if mapping.get("source"):
        entries = parse_xml(_read_file(mapping, mapping.get("source"), files, where), where)
    else:
        entries = mapping.find(expand_tag("ssm:ParameterMapping"))
    listed = () if entries is None else entries.findall(expand_tag("ssm:MappingEntry"))
    for entry in listed:
        source = entry.get("source")
        elements = [name for name in stated if source in (name, name.rpartition("[")[0])]
        if not elements:
            _log.warning("%s: the mapping's source %r is no parameter of the set: left out", where, source)
        for name in elements:
            target = entry.get("target") + name.removeprefix(source)
            yield target, _map(stated[name], entry, f"{where}: {name}")


def _map(stated: StatedValue, entry: Any, where: str) -> StatedValue:
    """What a mapping's entry makes of a value."""
    suppressed = entry.get("suppressUnitConversion") in SUPPRESSED
    if table := find_table(entry):
        value = look_up(*table, stated.value, where)
        return replace(stated, value=value, way=(Conversion("", suppressed=suppressed),))
    return replace(stated, way=(Conversion("", *read_transformation(entry, where), suppressed),))


def _read_file(element: Any, source: str, files: Files, where: str) -> bytes:
    if element.get("sourceBase", "SSD") != "SSD":
        raise ScenarioError(f"{where}: {source}: sourceBase 'component'; put the file into resources/")
    return files(resolve_source(source, where))


def _read_set(root: Any, found: Structure, where: str) -> Iterator[tuple[str, StatedValue]]:
    units = found.units | read_units(root)
    stated = dict.fromkeys(one.get("unit") or "" for one in root.iter())
    # Which the standard does not have.
    bracketed = [unit for unit in stated if unit[:1] == "[" and unit[-1:] == "]" and unit not in units]
    for unit in bracketed:
        _log.warning("%s: the unit %s is taken as %s", where, unit, unit[1:-1])
    enumerations = found.enumerations | read_enumerations(root)
    for parameter in root.iter(expand_tag("ssv:Parameter")):
        name = parameter.get("name")
        shape = [int(one.get("size")) for one in parameter.findall(expand_tag("ssc:Dimension"))]
        for child in parameter:
            kind = child.tag.rpartition("}")[2]
            if kind in ABOUT:
                continue
            texts = [one.get("value") for one in child] or [child.get("value")]
            if kind in (*REALS, *INTEGERS, *BOOLEANS) and kind != ENUMERATION:
                texts = texts[0].split()
            unit = child.get("unit") or ""
            unit = unit[1:-1] if unit in bracketed else unit
            items = enumerations.get(child.get("name") or name) if kind == ENUMERATION else None
            for element, text in zip(_list_elements(name, shape, texts, where), texts, strict=True):
                if kind in REALS:
                    yield element, StatedValue(float(text), unit, units)
                elif kind == ENUMERATION:
                    yield element, StatedValue(text, items=items)
                elif kind in INTEGERS:
                    yield element, StatedValue(float(int(text)))
                elif kind in BOOLEANS:
                    yield element, StatedValue(text in ("true", "1"))
                elif kind in (STRING, BINARY):
                    yield element, StatedValue(text, plain=True)
                else:
                    raise ScenarioError(f"{where}: {name}: a value of type {kind}; give one of SSP 2.0")


def _list_elements(name: str, shape: list[int], texts: list[str], where: str) -> list[str]:
    """The names of a parameter's elements, row by row; its own if it is no array."""
    if not shape and len(texts) == 1:
        return [name]
    shape = shape or [len(texts)]
    if math.prod(shape) != len(texts):
        sizes = " x ".join(map(str, shape))
        raise ScenarioError(f"{where}: {name} has {len(texts)} values: must be {sizes}; correct it")
    return [f"{name}[{','.join(map(str, one))}]" for one in product(*(range(1, n + 1) for n in shape))]


def _find_targets(
    found: Structure, path: Path, name: str, stated: StatedValue, where: str
) -> Iterator[tuple[Path, str, StatedValue]]:
    """The components' variables that `name` at the element of this path means, with what arrives there."""
    port = Port(path, name)
    if path in found.components:
        yield path, name, stated.enter(found.get_unit(port))
        return
    if port in found.kinds or port.array in found.kinds:
        if len(stated.way) > len(found.edges) + 1:
            raise ScenarioError(f"{where}: {port}: its connections lead back to it; take one out")
        entered = stated.enter(found.get_unit(port))
        for target, edge in found.list_edges(port):
            step = Conversion(found.get_unit(target), edge.factor, edge.offset, edge.suppressed)
            arrived = replace(entered, way=(*entered.way, step))
            yield from _find_targets(found, target.path, target.connector, arrived, where)
        return
    if "." not in name:
        raise ScenarioError(f"{where}: no parameter {name!r}; name a connector, or ELEMENT.PARAMETER")
    known = [*found.components, *(port.path for port in found.kinds)]
    inside = {other[len(path)] for other in known if other[: len(path)] == path and len(other) > len(path)}
    # Names of elements may have dots.
    element = max((one for one in inside if name.startswith(f"{one}.")), key=len, default="")
    if not element:
        # Sets are often shared between packages of different parts.
        _log.warning("%s: the value of %r is of no element of this package: left out", where, name)
        return
    yield from _find_targets(found, (*path, element), name[len(element) + 1 :], stated, where)
