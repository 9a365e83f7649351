"""An SSP as it is read: components in nested systems, connections between connectors, values.

A path is the names of systems and component from the outside in. What is not supported is refused by name.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from typing import Any, NamedTuple
from xml.etree import ElementTree

from ..participants.description import Unit
from ..scenario import ScenarioError
from .names import FMU_TYPE, tag

Path = tuple[str, ...]
# Gives the bytes of a file of the archive, by its path.
Files = Callable[[str], bytes]


class Port(NamedTuple):
    """A connector of a component or a system."""

    path: Path
    connector: str

    def __str__(self) -> str:
        return ".".join((*self.path, self.connector))


@dataclass(frozen=True)
class Edge:
    """What a connector gets its value from, and how."""

    source: Port
    factor: float | None
    offset: float | None
    suppressed: bool  # units are not converted


@dataclass
class Structure:
    """Everything that the package's SSD says.

    `components` gives the FMU's place in the archive, `units` of connectors that state one, `bindings` the
    elements with parameter bindings from the inside out.
    """

    name: str = ""
    description: str = ""
    components: dict[Path, str] = field(default_factory=dict)
    kinds: dict[Port, str] = field(default_factory=dict)
    connector_units: dict[Port, str] = field(default_factory=dict)
    edges: dict[Port, Edge] = field(default_factory=dict)
    bindings: list[tuple[Path, Any]] = field(default_factory=list)
    units: dict[str, Unit] = field(default_factory=dict)
    enumerations: dict[str, dict[str, int]] = field(default_factory=dict)
    experiment: dict[str, float] = field(default_factory=dict)
    annotations: list[Any] = field(default_factory=list)


def parsed(content: bytes, what: str) -> Any:
    """The root element; ScenarioError if it is no XML."""
    try:
        return ElementTree.fromstring(content)
    except ElementTree.ParseError as error:
        raise ScenarioError(f"{what}: not a valid XML file: {error}") from None


def structure_of(content: bytes, where: str) -> Structure:
    """What the SSD says; ScenarioError for what is not supported."""
    root = parsed(content, where)
    system = root.find(tag("ssd:System"))
    if root.tag != tag("ssd:SystemStructureDescription") or system is None:
        raise ScenarioError(
            f"{where}: no SystemStructureDescription of SSP 1 with a System; give another file"
        )
    found = Structure(root.get("name", ""), root.get("description") or "")
    found.units = units_of(root)
    found.enumerations = enumerations_of(root)
    experiment = root.find(tag("ssd:DefaultExperiment"))
    if experiment is not None:
        found.experiment = {
            key: float(experiment.get(key)) for key in ("startTime", "stopTime") if experiment.get(key)
        }
    found.annotations = [*root.iter(tag("ssc:Annotation"))]
    _System(found, where).read(system, (), {})
    return found


class _System:
    """Reads systems into a structure."""

    def __init__(self, found: Structure, where: str) -> None:
        self._found, self._where = found, where

    def _refuse(self, what: str, remedy: str) -> ScenarioError:
        return ScenarioError(f"{self._where}: {what}; {remedy}")

    def read(self, system: Any, path: Path, outer: dict[str, str]) -> None:
        """The system at `path`; `outer`: its signal dictionaries, by name."""
        self._connectors(system, path)
        dictionaries = outer | {
            one.get("name"): ".".join((*path, one.get("name")))
            for one in system.findall(f"{tag('ssd:SignalDictionaries')}/{tag('ssd:SignalDictionary')}")
        }
        # Elements that stand for the connectors of something else.
        places: dict[str, Path] = {}
        for element in system.iterfind(f"{tag('ssd:Elements')}/*"):
            own = (*path, element.get("name"))
            places[element.get("name")] = own
            if element.tag == tag("ssd:System"):
                self.read(element, own, dictionaries)
            elif element.tag == tag("ssd:Component"):
                self._component(element, own)
            elif element.tag == tag("ssd:SignalDictionaryReference"):
                name = element.get("dictionary")
                if name not in dictionaries:
                    raise self._refuse(f"{'.'.join(own)}: no signal dictionary {name!r}", "define it")
                places[element.get("name")] = (f"dictionary {dictionaries[name]}",)
        self._bound(system, path)
        for connection in system.iterfind(f"{tag('ssd:Connections')}/*"):
            self._connection(connection, path, places)

    def _component(self, element: Any, path: Path) -> None:
        shown, source = ".".join(path), element.get("source", "")
        kind = element.get("type", FMU_TYPE)
        if kind != FMU_TYPE:
            raise self._refuse(
                f"{shown}: a component of type {kind}",
                "components are FMUs here; put its content into this file",
            )
        if element.get("implementation") == "ModelExchange":
            raise self._refuse(f"{shown}: implementation ModelExchange", "give an FMU for co-simulation")
        self._found.components[path] = local(source, f"{self._where}: {shown}")
        self._connectors(element, path)
        self._bound(element, path)

    def _bound(self, element: Any, path: Path) -> None:
        for binding in element.iterfind(f"{tag('ssd:ParameterBindings')}/*"):
            self._found.bindings.append((path, binding))

    def _connectors(self, element: Any, path: Path) -> None:
        for connector in element.iterfind(f"{tag('ssd:Connectors')}/*"):
            port = Port(path, connector.get("name"))
            self._found.kinds[port] = connector.get("kind", "")
            real = connector.find(tag("ssc:Real"))
            if real is not None and real.get("unit"):
                self._found.connector_units[port] = real.get("unit")

    def _connection(self, connection: Any, path: Path, places: dict[str, Path]) -> None:
        def port(side: str) -> Port:
            element, connector = connection.get(f"{side}Element"), connection.get(f"{side}Connector")
            if element is None:
                return Port(path, connector)
            if element not in places:
                raise self._refuse(
                    f"a connection of {'.'.join(path) or 'the system'} names no element {element!r}",
                    "correct it",
                )
            return Port(places[element], connector)

        start, end = port("start"), port("end")
        factor, offset = transformation_of(connection, f"{self._where}: {start} to {end}")
        edge = Edge(start, factor, offset, connection.get("suppressUnitConversion") in ("true", "1"))
        if self._found.edges.setdefault(end, edge) is not edge:
            raise self._refuse(
                f"{end} has two sources, {self._found.edges[end].source} and {start}", "keep one"
            )


def transformation_of(element: Any, where: str) -> tuple[float | None, float | None]:
    """Factor and offset that are stated; ScenarioError for a transformation of another kind."""
    for child in element:
        if child.tag == tag("ssc:LinearTransformation"):
            return _float(child.get("factor")), _float(child.get("offset"))
        if "Transformation" in child.tag:
            name = child.tag.rpartition("}")[2]
            raise ScenarioError(f"{where}: a {name}; only linear transformations are known here, take one")
    return None, None


def _float(text: str | None) -> float | None:
    return None if text is None else float(text)


def local(source: str, where: str) -> str:
    """The archive's path of a source; ScenarioError for one elsewhere."""
    path = source.removeprefix("./")
    if not path or ":" in path or path.startswith("/") or ".." in path.split("/"):
        raise ScenarioError(
            f"{where}: source {source!r} is not in this package; put the file into resources/"
        )
    return path


def units_of(root: Any) -> dict[str, Unit]:
    """The units that a file defines."""
    names = ("kg", "m", "s", "A", "K", "mol", "cd", "rad")
    return {
        unit.get("name"): Unit(
            tuple(int(base.get(name, 0)) for name in names),
            float(base.get("factor", 1.0)),
            float(base.get("offset", 0.0)),
        )
        for unit in root.iter(tag("ssc:Unit"))
        for base in unit.findall(tag("ssc:BaseUnit"))
    }


def enumerations_of(root: Any) -> dict[str, dict[str, int]]:
    """The enumerations that a file defines: items and their values."""
    return {
        one.get("name"): {item.get("name"): int(item.get("value")) for item in one.iter(tag("ssc:Item"))}
        for one in root.iter(tag("ssc:Enumeration"))
        if one.find(tag("ssc:Item")) is not None
    }


def way(found: Structure, target: Port) -> Iterator[tuple[Port, Edge]]:
    """The connections that lead to `target`, from it backwards: the connector at the end of each, and it."""
    seen = set()
    while target in found.edges and target not in seen:
        seen.add(target)
        edge = found.edges[target]
        yield target, edge
        target = edge.source
        if target.path in found.components:
            return
