"""Writes a scenario as an SSP package: FMUs, connections, values and our own settings.

Values that the scenario states are in one parameter set for each component; the states of the equilibrium
that it starts from, which other tools cannot find, in another. What SSP has no place for (master, tolerances,
outputs) is an annotation.
"""

import hashlib
import io
import json
import re
import zipfile
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from models.core.quantities import Quantity
from models.core.system import Instance

from ...engine.instants import SideLines
from ...errors import Option
from ...participants.description import (
    BINARY,
    BOOLEANS,
    CLOCK,
    REALS,
    STRING,
    Description,
    Variable,
    read_description,
)
from ...participants.description3 import STRUCTURAL
from ...participants.open_fmu import collect_settings
from ...store.atomic_write import write_whole
from .. import Line, Scenario, ScenarioError, parse_line
from ..system import Assembly, Builder, assemble, resolve_start
from ..values import SECTIONS
from .names import (
    FMU_TYPE,
    OMSIMULATOR,
    OSP,
    OURS,
    RESOURCES,
    STRUCTURE,
    VALUES_TYPE,
    add_element,
    format_value,
    to_bytes,
)

# Of the standard, the default first, which most tools read.
VERSIONS = ("1.0", "2.0")
OF_2 = "use ", Option("version", VERSIONS[1])
# A fixed date: the same scenario gives the same bytes.
_DATE = (1980, 1, 1, 0, 0, 0)


@dataclass(frozen=True)
class PackedFmu:
    """The FMU of a component: its path in the archive, bytes and description."""

    source: str
    content: bytes
    about: Description

    @property
    def sha256(self) -> str:
        return hashlib.sha256(self.content).hexdigest()


def export(scenario: Scenario, target: Path, build: Builder, version: str = VERSIONS[0]) -> None:
    """Write the scenario to `target`, whole or not at all, as SSP of that version.

    ScenarioError or ModelError if it cannot run, ScenarioError for what SSP 1.0 does not have.
    """
    assembly = assemble(scenario)
    system = assembly.system
    if version == "1.0":
        _check_packable(scenario, assembly.side_lines)
    fmus = _pack(scenario, build)
    files = {fmu.source: fmu.content for fmu in fmus.values()}
    bindings: dict[str, list[str]] = {name: [] for name in scenario.components}
    resting = scenario.start == "equilibrium"
    started = resolve_start(scenario, system) if resting else system
    for name, instance in system.instances.items():
        table = scenario.components[name]
        sizes = table.structure if table.third_party else {}
        asked = collect_settings(instance)
        stated: dict[str, Any] = {**sizes, **asked.values, **asked.inputs, **table.strings}
        rest = collect_settings(started.instances[name]).values if resting else {}
        computed = {key: value for key, value in rest.items() if key not in instance.parameters}
        for suffix, values in (("", stated), (START, computed)):
            if values:
                path = f"{RESOURCES}/{name}{suffix}.ssv"
                files[path] = _write_parameter_set(values, fmus[name].about, instance, version)
                bindings[name].append(path)
    structure = _write_structure(scenario, assembly, fmus, bindings, version)
    files = {STRUCTURE: to_bytes(structure), **files}
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w", zipfile.ZIP_DEFLATED) as archive:
        for path, content in files.items():
            kind = (
                zipfile.ZIP_STORED if path.endswith(".fmu") else zipfile.ZIP_DEFLATED
            )  # is compressed already
            archive.writestr(zipfile.ZipInfo(path, _DATE), content, kind)
    write_whole(target, buffer.getvalue())


def _check_packable(scenario: Scenario, sides: SideLines) -> None:
    """ScenarioError for what this form of packages does not have."""
    for name, table in scenario.components.items():
        if table.third_party and table.structure:
            raise ScenarioError(
                f"components.{name}.structure: packages of SSP 1.0 have no structural parameters", OF_2
            )
    if found := [*sides.clocks, *sides.texts]:
        raise ScenarioError(
            f"{found[0].source} -> {found[0].target}: packages of SSP 1.0 connect numbers only", OF_2
        )


# The name of all parameter sets: ecos applies those of the one name that it is asked for.
SET = "values"
# What the files of parameter sets with computed states end in.
START = ".equilibrium"


def _pack(scenario: Scenario, build: Builder) -> dict[str, PackedFmu]:
    """Every component's FMU; equal files once."""
    places: dict[str, str] = {}
    packed = {}
    for name, table in scenario.components.items():
        kind = "fmu" if table.participant == "in-process" else table.participant
        path = table.file or build(str(table.component), table.structure, kind)
        content = path.read_bytes()
        stem = path.stem if table.file else str(table.component)
        digest = hashlib.sha256(content).hexdigest()
        if digest not in places:
            taken = sum(place.startswith(f"{RESOURCES}/{stem}.") for place in places.values())
            places[digest] = f"{RESOURCES}/{stem}.{taken}.fmu" if taken else f"{RESOURCES}/{stem}.fmu"
        about = table.describe() if table.third_party else read_description(path)
        packed[name] = PackedFmu(places[digest], content, about)
    return packed


def _write_parameter_set(
    values: Mapping[str, float | str], about: Description, instance: Instance, version: str
) -> bytes:
    root = add_element(None, "ssv:ParameterSet", version=version, name=SET)
    parameters = add_element(root, "ssv:Parameters")
    for name, elements in _list_wholes(about, values, version).items():
        parameter = add_element(parameters, "ssv:Parameter", name=name)
        written = [
            _format_value(v, _find_quantity(instance, v.name), values.get(v.name, v.start or 0.0), version)
            for v in elements
        ]
        kind, value = written[0]
        if len(elements) == 1:
            add_element(parameter, f"ssv:{kind}", value=value)
        elif isinstance(value, str):
            several = add_element(parameter, f"ssv:{kind}")
            for _, one in written:
                add_element(several, "ssv:Value", value=one)
        else:
            add_element(parameter, f"ssv:{kind}", value=" ".join(format_value(one) for _, one in written))
        _write_dimensions(parameter, elements)
    return to_bytes(root)


def _list_wholes(about: Description, names: Iterable[str], version: str) -> dict[str, list[Variable]]:
    """The variables of these names; those of SSP 2.0 are whole arrays, with all their elements row by row."""
    if version == "1.0":
        return {name: [about.variables[name]] for name in names}
    arrays: dict[str, list[Variable]] = {}
    for variable in about.variables.values():
        arrays.setdefault(variable.whole, []).append(variable)
    return {(whole := about.variables[name].whole): arrays[whole] for name in names}


def _write_dimensions(parent: Any, elements: list[Variable]) -> None:
    if elements[0].name != elements[0].whole and parent.get("name") == elements[0].whole:
        for size in elements[-1].index.strip("[]").split(","):
            add_element(parent, "ssc:Dimension", size=size)


def _find_quantity(instance: Instance, name: str) -> Quantity | None:
    layout = instance.component.parameters
    return layout.field(name).quantity if name in layout else None


def _format_value(
    variable: Variable, quantity: Quantity | None, value: float | str, version: str
) -> tuple[str, Any]:
    """Type and value of a parameter."""
    kind = _get_type(variable, quantity, version)
    if isinstance(value, str):
        return kind, value
    if variable.type in (*REALS, CLOCK):  # of a clock its interval
        return "Real" if variable.type == CLOCK else kind, float(value)
    if variable.type in BOOLEANS:
        return kind, bool(value)
    if kind == "Enumeration":
        return kind, next(name for name, number in _list_items(variable, quantity) if number == value)
    return kind, int(value)


def _list_items(variable: Variable, quantity: Quantity | None) -> tuple[tuple[str, int], ...]:
    """Of an enumeration, with their numbers."""
    choices = quantity.choices if quantity is not None else ()
    return tuple((name, number) for number, name in enumerate(choices)) or variable.items


def _get_type(variable: Variable, quantity: Quantity | None, version: str) -> str:
    """The standard's. Enumerations without items go as numbers, third-party FMUs' in SSP 1.0 all do."""
    if quantity is not None and quantity.choices:
        return "Enumeration"
    if version != "1.0":
        return variable.type if variable.type != "Enumeration" or variable.items else "Integer"
    if variable.type in REALS:
        return "Real"
    return variable.type if variable.type in (*BOOLEANS, STRING, BINARY, CLOCK) else "Integer"


def _write_structure(
    scenario: Scenario,
    assembly: Assembly,
    fmus: Mapping[str, PackedFmu],
    bindings: Mapping[str, list[str]],
    version: str,
) -> Any:
    system, sides = assembly.system, assembly.side_lines
    root = add_element(
        None,
        "ssd:SystemStructureDescription",
        version=version,
        name=re.sub(r"\W", "_", scenario.name),  # OMSimulator takes identifiers only
        description=scenario.description or None,
        generationTool="tribocosim",
    )
    whole = add_element(root, "ssd:System", name="system")
    elements = add_element(whole, "ssd:Elements")
    lines = [*system.connections, *sides.clocks, *sides.texts]
    connected = {str(port) for line in lines for port in (line.source, line.target)}
    enumerations: dict[str, tuple[tuple[str, int], ...]] = {}
    for name, instance in system.instances.items():
        fmu = fmus[name]
        component = add_element(
            elements,
            "ssd:Component",
            name=name,
            type=FMU_TYPE,
            source=fmu.source,
            implementation="ModelExchange" if fmu.about.integrated else "CoSimulation",
        )
        connectors = add_element(component, "ssd:Connectors")
        for called, variables in _list_wholes(fmu.about, fmu.about.variables, version).items():
            if kind := _get_connector_kind(name, variables, connected, version):
                connector = add_element(connectors, "ssd:Connector", name=called, kind=kind)
                quantity = _find_quantity(instance, variables[0].name)
                _write_type(connector, variables[0], quantity, enumerations, version)
                _write_dimensions(connector, variables)
        if bindings[name]:
            sets = add_element(component, "ssd:ParameterBindings")
            for path in bindings[name]:
                add_element(sets, "ssd:ParameterBinding", type=VALUES_TYPE, source=path)
    if lines:
        connections = add_element(whole, "ssd:Connections")
        for text in scenario.connections:
            _write_connection(connections, parse_line(text), fmus, version)
    # OMSimulator refuses annotations of the whole file.
    annotations = add_element(whole, "ssd:Annotations")
    _write_omsimulator(annotations, scenario)
    ours = add_element(annotations, "ssc:Annotation", type=OURS)
    settings = add_element(ours, "tribocosim:Settings")
    settings.text = json.dumps(_collect_settings(scenario, fmus), ensure_ascii=False)
    if enumerations:
        listed = add_element(root, "ssd:Enumerations")
        for name, items in enumerations.items():
            one = add_element(listed, "ssc:Enumeration", name=name)
            for item, number in items:
                add_element(one, "ssc:Item", name=item, value=number)
    _write_units(root, fmus)
    experiment = add_element(root, "ssd:DefaultExperiment", startTime=0.0, stopTime=scenario.stop_time)
    _write_osp(experiment, scenario)
    return root


def _get_connector_kind(name: str, variables: list[Variable], connected: set[str], version: str) -> str:
    """A connector's kind; empty for variables that have none. An input that nothing drives would be set to
    zero by some tools if it were shown."""
    first, linked = variables[0], any(f"{name}.{v.name}" in connected for v in variables)
    if first.variability == "constant" or not (first.numeric or (linked and version != "1.0")):
        return ""
    if first.causality == "input":
        return "input" if linked else ""
    kinds = ("output", "parameter", *((STRUCTURAL,) if version != "1.0" else ()))
    return first.causality if first.causality in kinds else ""


def _write_type(
    connector: Any,
    variable: Variable,
    quantity: Quantity | None,
    enumerations: dict[str, tuple[tuple[str, int], ...]],
    version: str,
) -> None:
    kind, about = _get_type(variable, quantity, version), {}
    if variable.type in REALS:
        about = {"unit": variable.unit or None}
    elif kind == "Enumeration":
        enumerations[variable.whole] = _list_items(variable, quantity)
        about = {"name": variable.whole}
    add_element(connector, f"ssc:{kind}", **about)


def _write_connection(parent: Any, line: Line, fmus: Mapping[str, PackedFmu], version: str) -> None:
    changed = line.factor is not None or line.offset is not None
    ends: dict[str, str] = {}
    for side, port in (("start", line.source), ("end", line.target)):
        element, name = port.split(".", 1)
        variable = fmus[element].about.variables[name]
        ends |= {f"{side}Element": element, f"{side}Connector": name}
        if version != "1.0" and variable.index:
            indices = variable.index.strip("[]").replace(",", " ")
            ends |= {f"{side}Connector": variable.whole, f"{side}Indices": indices}
    connection = add_element(
        parent, "ssd:Connection", **ends, suppressUnitConversion=True if changed else None
    )
    if changed:
        add_element(connection, "ssc:LinearTransformation", factor=line.factor, offset=line.offset)


def _write_units(root: Any, fmus: Mapping[str, PackedFmu]) -> None:
    units = {name: unit for fmu in fmus.values() for name, unit in fmu.about.units.items()}
    used = {v.unit for fmu in fmus.values() for v in fmu.about.variables.values()}
    if not used & set(units):
        return
    listed = add_element(root, "ssd:Units")
    names = ("kg", "m", "s", "A", "K", "mol", "cd", "rad")
    for name in sorted(used & set(units)):
        unit = units[name]
        base = {key: power for key, power in zip(names, unit.exponents, strict=True) if power}
        add_element(
            add_element(listed, "ssc:Unit", name=name),
            "ssc:BaseUnit",
            **base,
            factor=None if unit.factor == 1.0 else unit.factor,
            offset=unit.offset or None,
        )


def _write_omsimulator(annotations: Any, scenario: Scenario) -> None:
    annotation = add_element(annotations, "ssc:Annotation", type=OMSIMULATOR)
    information = add_element(add_element(annotation, "oms:Annotations"), "oms:SimulationInformation")
    add_element(
        information,
        "oms:FixedStepMaster",
        description="oms-ma",
        stepSize=scenario.macro_step,
        absoluteTolerance=1e-4,
        relativeTolerance=1e-4,
    )


def _write_osp(experiment: Any, scenario: Scenario) -> None:
    annotation = add_element(add_element(experiment, "ssd:Annotations"), "ssc:Annotation", type=OSP)
    add_element(
        add_element(annotation, "osp:Algorithm"), "osp:FixedStepAlgorithm", baseStepSize=scenario.macro_step
    )


def _collect_settings(scenario: Scenario, fmus: Mapping[str, PackedFmu]) -> dict[str, Any]:
    """What SSP has no place for; and by which FMUs a component's own may take its place again."""
    content: dict[str, Any] = scenario.model_dump(exclude_none=True)
    for key in ("connections", "stop_time"):
        del content[key]
    for name, table in content["components"].items():
        for key in SECTIONS:
            table.pop(key, None)
        if table["participant"].endswith(".fmu"):
            del table["participant"]
        else:
            table["sha256"] = fmus[name].sha256
    return content
