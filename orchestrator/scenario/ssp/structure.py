"""An SSP as it is read: components in nested systems, connections between connectors, values.

A path is the names of systems and component from the outside in. What is not supported is refused by name.
"""

import posixpath
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace
from typing import Any, NamedTuple
from urllib.parse import unquote
from xml.etree import ElementTree

from ...participants.description import REALS, Unit
from .. import ScenarioError
from ..conversion import find_unit
from .names import DEFINITION_TYPE, FMU_TYPE, PACKAGE_TYPE, STRUCTURE, UNPACKED, correct_tag, expand_tag
from .tables import find_table, to_line

Path = tuple[str, ...]
# The elements whose source is a file.
_WITH_SOURCE = ("Component", "ParameterBinding", "ParameterMapping", "SignalDictionary")
SOURCED = {expand_tag(f"ssd:{name}") for name in _WITH_SOURCE}
# The kinds of connectors to which connections lead: of elements, and of the system that is around them.
RECEIVING = ("input", "inout", "parameter", "structuralParameter")
RECEIVING_OF_SYSTEM = ("output", "local", "calculatedParameter", "constant")
# Gives the bytes of a file of the archive, by its path.
Files = Callable[[str], bytes]


class Port(NamedTuple):
    """A connector of a component or a system."""

    path: Path
    connector: str

    def __str__(self) -> str:
        return ".".join((*self.path, self.connector))

    @property
    def array(self) -> "Port":
        """The connector of the whole array of which this is an element."""
        return Port(self.path, self.connector.rpartition("[")[0])

    def pick(self, element: "Port") -> "Port":
        """The element of this array with the index of another's `element`."""
        index = element.connector.removeprefix(element.array.connector)
        return Port(self.path, self.connector + index)


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

    `components` gives the FMU's place in the archive, `integrated` are those of model exchange, `units` of
    connectors that state one, `bindings` the elements with parameter bindings from the inside out.
    """

    name: str = ""
    description: str = ""
    components: dict[Path, str] = field(default_factory=dict)
    integrated: set[Path] = field(default_factory=set)
    kinds: dict[Port, str] = field(default_factory=dict)
    connector_units: dict[Port, str] = field(default_factory=dict)
    edges: dict[Port, Edge] = field(default_factory=dict)
    bindings: list[tuple[Path, Any]] = field(default_factory=list)
    units: dict[str, Unit] = field(default_factory=dict)
    enumerations: dict[str, dict[str, int]] = field(default_factory=dict)
    experiment: dict[str, float] = field(default_factory=dict)
    annotations: list[Any] = field(default_factory=list)

    def get_unit(self, port: Port) -> str:
        """That the connector states, or its array's."""
        return self.connector_units.get(port) or self.connector_units.get(port.array, "")

    def find_edge(self, target: Port) -> Edge | None:
        """The connection to a connector, or to the same element through its array."""
        whole = self.edges.get(target.array)
        if target in self.edges or whole is None:
            return self.edges.get(target)
        return replace(whole, source=whole.source.pick(target))

    def list_edges(self, source: Port) -> Iterator[tuple[Port, Edge]]:
        """Where connections from a connector end, or from its element through its array; and they."""
        for target, edge in self.edges.items():
            if edge.source == source:
                yield target, edge
            elif edge.source == source.array:
                yield target.pick(source), edge


def parse_xml(content: bytes, what: str) -> Any:
    """The root element; ScenarioError if it is no XML."""
    try:
        root = ElementTree.fromstring(content)
    except ElementTree.ParseError as error:
        raise ScenarioError(f"{what}: not a valid XML file: {error}") from None
    for element in root.iter():
        if isinstance(element.tag, str):
            element.tag = correct_tag(element.tag)
    return root


def check_version(root: Any, where: str) -> None:
    """ScenarioError for a file of a later SSP, of which something could be missed."""
    version = root.get("version") or "1.0"
    if version[:1].isdigit() and not version.startswith(("1.", "2.")):
        raise ScenarioError(f"{where}: is of SSP {version}; export it as SSP 2.0")


def read_structure(files: Files, where: str) -> Structure:
    """What the package's SSD, and those that it names, say; ScenarioError for what is not supported."""
    root, system = _parse_structure(files(STRUCTURE), where)
    found = Structure(root.get("name", ""), root.get("description") or "")
    found.units = read_units(root)
    found.enumerations = read_enumerations(root)
    experiment = root.find(expand_tag("ssd:DefaultExperiment"))
    if experiment is not None:
        found.experiment = {
            key: float(experiment.get(key)) for key in ("startTime", "stopTime") if experiment.get(key)
        }
    found.annotations = [*root.iter(expand_tag("ssc:Annotation"))]
    _SystemReader(found, where, files).read(system, (), {})
    # A component's variable has a unit of its own, which is taken where the connector's is unknown.
    for port, unit in [*found.connector_units.items()]:
        if port.path in found.components and find_unit(unit, found.units) is None:
            del found.connector_units[port]
    return found


def _parse_structure(content: bytes, where: str) -> tuple[Any, Any]:
    """The root of an SSD, and its system."""
    root = parse_xml(content, where)
    check_version(root, where)
    system = root.find(expand_tag("ssd:System"))
    if root.tag != expand_tag("ssd:SystemStructureDescription") or system is None:
        raise ScenarioError(
            f"{where}: no SystemStructureDescription of SSP 1 with a System; give another file"
        )
    return root, system


class _SystemReader:
    """Reads systems into a structure."""

    def __init__(self, found: Structure, where: str, files: Files) -> None:
        self._found, self._where, self._files = found, where, files
        self._inside: tuple[str, ...] = ()  # the SSDs that are being read, from the outside in

    def _refuse(self, what: str, remedy: str) -> ScenarioError:
        return ScenarioError(f"{self._where}: {what}; {remedy}")

    def read(self, system: Any, path: Path, outer: dict[str, str]) -> None:
        """The system at `path`; `outer`: its signal dictionaries, by name."""
        self._read_connectors(system, path)
        dictionaries = outer | {
            one.get("name"): self._read_dictionary(one, path)
            for one in system.findall(
                f"{expand_tag('ssd:SignalDictionaries')}/{expand_tag('ssd:SignalDictionary')}"
            )
        }
        # Elements that stand for the connectors of something else.
        places: dict[str, Path] = {}
        for element in system.iterfind(f"{expand_tag('ssd:Elements')}/*"):
            own = (*path, element.get("name"))
            places[element.get("name")] = own
            if element.tag == expand_tag("ssd:System"):
                self.read(element, own, dictionaries)
            elif element.tag == expand_tag("ssd:Component"):
                self._read_component(element, own)
            elif element.tag == expand_tag("ssd:SignalDictionaryReference"):
                name = element.get("dictionary")
                if name not in dictionaries:
                    raise self._refuse(f"{'.'.join(own)}: no signal dictionary {name!r}", "define it")
                places[element.get("name")] = place = (f"dictionary {dictionaries[name]}",)
                for connector in element.iterfind(f"{expand_tag('ssd:Connectors')}/*"):
                    self._read_unit(connector, Port(place, connector.get("name")))
        self._read_bindings(system, path)
        for connection in system.iterfind(f"{expand_tag('ssd:Connections')}/*"):
            self._read_connection(connection, path, places)

    def _read_component(self, element: Any, path: Path) -> None:
        shown, source = ".".join(path), element.get("source", "")
        kind = element.get("type", FMU_TYPE)
        if kind in (DEFINITION_TYPE, PACKAGE_TYPE):
            self._read_nested(resolve_source(source, f"{self._where}: {shown}"), kind, path)
            self._read_bindings(element, path)
            return
        if kind != FMU_TYPE:
            raise self._refuse(
                f"{shown}: a component of type {kind}",
                "components are FMUs or SSP systems here; put its content into this file",
            )
        implementation = element.get("implementation")
        if implementation == "ModelExchange":
            self._found.integrated.add(path)
        if implementation == "ScheduledExecution":
            raise self._refuse(
                f"{shown}: implementation 'ScheduledExecution'", "give it as CoSimulation or ModelExchange"
            )
        self._found.components[path] = resolve_source(source, f"{self._where}: {shown}")
        self._read_connectors(element, path)
        self._read_bindings(element, path)

    def _read_nested(self, source: str, kind: str, path: Path) -> None:
        """The system of another SSD, or of another package, in the place of a component."""
        file = f"{source}{UNPACKED}/{STRUCTURE}" if kind == PACKAGE_TYPE else source
        if file in self._inside:
            raise self._refuse(f"{'.'.join(path)}: {source} contains itself", "take it out")
        root, system = _parse_structure(self._files(file), f"{self._where}: {source}")
        for element in system.iter():  # its sources are relative to itself
            inner = element.get("source", "")
            if inner and element.tag in SOURCED and ":" not in inner and not inner.startswith("/"):
                element.set("source", posixpath.normpath(posixpath.join(posixpath.dirname(file), inner)))
        self._found.units = read_units(root) | self._found.units
        self._found.enumerations = read_enumerations(root) | self._found.enumerations
        before, self._inside = self._inside, (*self._inside, file)
        self.read(system, path, {})
        self._inside = before

    def _read_bindings(self, element: Any, path: Path) -> None:
        for binding in element.iterfind(f"{expand_tag('ssd:ParameterBindings')}/*"):
            self._found.bindings.append((path, binding))

    def _read_connectors(self, element: Any, path: Path) -> None:
        for connector in element.iterfind(f"{expand_tag('ssd:Connectors')}/*"):
            port = Port(path, connector.get("name"))
            self._found.kinds[port] = connector.get("kind", "")
            self._read_unit(connector, port)

    def _read_unit(self, element: Any, port: Port) -> None:
        for kind in REALS:
            real = element.find(expand_tag(f"ssc:{kind}"))
            if real is not None and real.get("unit"):
                self._found.connector_units[port] = real.get("unit")

    def _read_dictionary(self, element: Any, path: Path) -> str:
        """Read the units of a signal dictionary's entries; the name by which it is known here."""
        shown = ".".join((*path, element.get("name")))
        root: Any = element.find(expand_tag("ssb:SignalDictionary"))
        if source := element.get("source"):
            where = f"{self._where}: {shown}"
            root = parse_xml(self._files(resolve_source(source, where)), where)
        if root is not None:
            check_version(root, f"{self._where}: {shown}")
            self._found.units = read_units(root) | self._found.units
            for entry in root.iter(expand_tag("ssb:DictionaryEntry")):
                self._read_unit(entry, Port((f"dictionary {shown}",), entry.get("name")))
        return shown

    def _read_connection(self, connection: Any, path: Path, places: dict[str, Path]) -> None:
        def port(side: str) -> Port:
            element, connector = connection.get(f"{side}Element"), connection.get(f"{side}Connector")
            if indices := connection.get(f"{side}Indices", "").split():
                connector = f"{connector}[{','.join(indices)}]"
            if not element:  # some tools write an empty name
                return Port(path, connector)
            if element not in places:
                raise self._refuse(
                    f"a connection of {'.'.join(path) or 'the system'} names no element {element!r}",
                    "correct it",
                )
            return Port(places[element], connector)

        start, end = port("start"), port("end")
        if self._receives(start, path) and not self._receives(end, path):
            start, end = end, start  # the names do not tell the direction
        factor, offset = read_transformation(connection, f"{self._where}: {start} to {end}")
        edge = Edge(start, factor, offset, connection.get("suppressUnitConversion") in ("true", "1"))
        if self._found.edges.setdefault(end, edge) is not edge:
            raise self._refuse(
                f"{end} has two sources, {self._found.edges[end].source} and {start}", "keep one"
            )

    def _receives(self, port: Port, system: Path) -> bool:
        """Whether a connection within the system leads to this connector, by its kind."""
        kinds = RECEIVING_OF_SYSTEM if port.path == system else RECEIVING
        return (self._found.kinds.get(port) or self._found.kinds.get(port.array)) in kinds


def read_transformation(element: Any, where: str) -> tuple[float | None, float | None]:
    """Factor and offset that are stated; ScenarioError for a transformation of another kind."""
    for child in element:
        if child.tag == expand_tag("ssc:LinearTransformation"):
            return _parse_float(child.get("factor")), _parse_float(child.get("offset"))
    table = find_table(element)
    return to_line(*table, where) if table else (None, None)


def _parse_float(text: str | None) -> float | None:
    return None if text is None else float(text)


def resolve_source(source: str, where: str) -> str:
    """The archive's path of a source; ScenarioError for one elsewhere."""
    path = source.removeprefix("./")
    plain = unquote(path).replace("\\", "/")  # which Windows takes for /
    if not path or ":" in plain or plain.startswith("/") or ".." in plain.split("/"):
        raise ScenarioError(
            f"{where}: source {source!r} is not in this package; put the file into resources/"
        )
    return path


def read_units(root: Any) -> dict[str, Unit]:
    """The units that a file defines."""
    names = ("kg", "m", "s", "A", "K", "mol", "cd", "rad")
    return {
        unit.get("name"): Unit(
            tuple(int(base.get(name, 0)) for name in names),
            float(base.get("factor", 1.0)),
            float(base.get("offset", 0.0)),
        )
        for unit in root.iter(expand_tag("ssc:Unit"))
        for base in unit.findall(expand_tag("ssc:BaseUnit"))
    }


def read_enumerations(root: Any) -> dict[str, dict[str, int]]:
    """The enumerations that a file defines: items and their values."""
    return {
        one.get("name"): {
            item.get("name"): int(item.get("value")) for item in one.iter(expand_tag("ssc:Item"))
        }
        for one in root.iter(expand_tag("ssc:Enumeration"))
        if one.find(expand_tag("ssc:Item")) is not None
    }


def trace_back(found: Structure, target: Port) -> Iterator[tuple[Port, Edge]]:
    """The connections that lead to `target`, from it backwards: the connector at the end of each, and it."""
    seen = set()
    while (edge := found.find_edge(target)) and target not in seen:
        seen.add(target)
        yield target, edge
        target = edge.source
        if target.path in found.components:
            return
