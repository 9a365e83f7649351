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
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from models.core.quantities import Quantity
from models.core.system import Instance, System

from ...engine.instants import SideLines
from ...participants.description import BOOLEANS, CLOCK, REALS, Description, Variable, read_description
from ...participants.open_fmu import collect_settings
from ...store.atomic_write import replace
from .. import ComponentTable, Scenario, ScenarioError, parse_line
from ..system import Builder, assemble, resolve_start
from .names import (
    FMU_TYPE,
    OMSIMULATOR,
    OSP,
    OURS,
    RESOURCES,
    STRUCTURE,
    VALUES_TYPE,
    add_element,
    to_bytes,
)

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


def export(scenario: Scenario, target: Path, build: Builder) -> None:
    """Write the scenario to `target`, whole or not at all; ScenarioError or ModelError if it cannot run."""
    assembly = assemble(scenario)
    system = assembly.system
    _check_packable(scenario, assembly.side_lines)
    fmus = _pack(scenario, build)
    files = {fmu.source: fmu.content for fmu in fmus.values()}
    bindings: dict[str, list[str]] = {name: [] for name in scenario.components}
    resting = scenario.start == "equilibrium"
    started = resolve_start(scenario, system) if resting else system
    for name, instance in system.instances.items():
        stated: dict[str, Any] = {**_collect_values(instance), **scenario.components[name].strings}
        rest = collect_settings(started.instances[name]).values if resting else {}
        computed = {key: value for key, value in rest.items() if key not in instance.parameters}
        for suffix, values in (("", stated), (START, computed)):
            if values:
                path = f"{RESOURCES}/{name}{suffix}.ssv"
                files[path] = _write_parameter_set(SET, values, fmus[name].about, instance)
                bindings[name].append(path)
    files = {STRUCTURE: to_bytes(_write_structure(scenario, system, fmus, bindings)), **files}
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w", zipfile.ZIP_DEFLATED) as archive:
        for path, content in files.items():
            kind = (
                zipfile.ZIP_STORED if path.endswith(".fmu") else zipfile.ZIP_DEFLATED
            )  # is compressed already
            archive.writestr(zipfile.ZipInfo(path, _DATE), content, kind)
    replace(target, buffer.getvalue())


def _check_packable(scenario: Scenario, sides: SideLines) -> None:
    """ScenarioError for what this form of packages does not have."""
    for name, table in scenario.components.items():
        if table.third_party and table.structure:
            raise ScenarioError(
                f"components.{name}.structure: packages of SSP 1.0 have no structural parameters; leave it "
                "out, or give the scenario with its FMUs"
            )
    if found := [*sides.clocks, *sides.texts]:
        raise ScenarioError(
            f"{found[0].source} -> {found[0].target}: packages are written with connections of numbers only; "
            "leave it out, or give the scenario with its FMUs"
        )


# The name of all parameter sets: ecos applies those of the one name that it is asked for.
SET = "values"
# What the files of parameter sets with computed states end in.
START = ".equilibrium"


def _get_kind(table: ComponentTable) -> str:
    """Of the FMU that is built; a package has one for every component."""
    return "fmu" if table.participant == "in-process" else table.participant


def _pack(scenario: Scenario, build: Builder) -> dict[str, PackedFmu]:
    """Every component's FMU; equal files once."""
    places: dict[str, str] = {}
    packed = {}
    for name, table in scenario.components.items():
        given_file = table.participant.endswith(".fmu") or table.component is None
        path = (
            Path(table.participant)
            if given_file
            else build(str(table.component), table.structure, _get_kind(table))
        )
        content = path.read_bytes()
        stem = path.stem if given_file else str(table.component)
        digest = hashlib.sha256(content).hexdigest()
        if digest not in places:
            taken = sum(place.startswith(f"{RESOURCES}/{stem}.") for place in places.values())
            places[digest] = f"{RESOURCES}/{stem}.{taken}.fmu" if taken else f"{RESOURCES}/{stem}.fmu"
        packed[name] = PackedFmu(places[digest], content, read_description(path))
    return packed


def _collect_values(instance: Instance) -> dict[str, float]:
    """The values that the scenario states, by the FMU's variables."""
    asked = collect_settings(instance)
    return {**asked.values, **asked.inputs}


def _write_parameter_set(
    name: str, values: Mapping[str, float | str], about: Description, instance: Instance
) -> bytes:
    root = add_element(None, "ssv:ParameterSet", version="1.0", name=name)
    parameters = add_element(root, "ssv:Parameters")
    for key, value in values.items():
        parameter = add_element(parameters, "ssv:Parameter", name=key)
        kind, written = about.variables[key].type, value
        if not isinstance(value, str):
            kind, written = _format_value(about.variables[key], _find_quantity(instance, key), value)
        add_element(parameter, f"ssv:{kind}", value=written)
    return to_bytes(root)


def _find_quantity(instance: Instance, name: str) -> Quantity | None:
    layout = instance.component.parameters
    return layout.field(name).quantity if name in layout else None


def _format_value(variable: Variable, quantity: Quantity | None, value: float) -> tuple[str, Any]:
    """Type and value of a parameter."""
    if variable.type in (*REALS, CLOCK):  # of a clock its interval
        return "Real", float(value)
    if variable.type in BOOLEANS:
        return "Boolean", bool(value)
    if quantity is not None and quantity.choices:
        return "Enumeration", quantity.choices[int(value)]
    return "Integer", int(value)


def _write_structure(
    scenario: Scenario, system: System, fmus: Mapping[str, PackedFmu], bindings: Mapping[str, list[str]]
) -> Any:
    root = add_element(
        None,
        "ssd:SystemStructureDescription",
        version="1.0",
        name=re.sub(r"\W", "_", scenario.name),  # OMSimulator takes identifiers only
        description=scenario.description or None,
        generationTool="tribocosim",
    )
    whole = add_element(root, "ssd:System", name="system")
    elements = add_element(whole, "ssd:Elements")
    driven = {str(connection.target) for connection in system.connections}
    enumerations: dict[str, tuple[str, ...]] = {}
    for name, instance in system.instances.items():
        fmu = fmus[name]
        component = add_element(
            elements,
            "ssd:Component",
            name=name,
            type=FMU_TYPE,
            source=fmu.source,
            implementation="CoSimulation",
        )
        connectors = add_element(component, "ssd:Connectors")
        for variable in fmu.about.variables.values():
            if kind := _get_connector_kind(name, variable, driven, instance):
                connector = add_element(connectors, "ssd:Connector", name=variable.name, kind=kind)
                _write_type(connector, variable, _find_quantity(instance, variable.name), enumerations)
        if bindings[name]:
            sets = add_element(component, "ssd:ParameterBindings")
            for path in bindings[name]:
                add_element(sets, "ssd:ParameterBinding", type=VALUES_TYPE, source=path)
    if system.connections:
        connections = add_element(whole, "ssd:Connections")
        for text in scenario.connections:
            _write_connection(connections, text)
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
            for number, item in enumerate(items):
                add_element(one, "ssc:Item", name=item, value=number)
    _write_units(root, fmus)
    experiment = add_element(root, "ssd:DefaultExperiment", startTime=0.0, stopTime=scenario.stop_time)
    _write_osp(experiment, scenario)
    return root


def _get_connector_kind(name: str, variable: Variable, driven: set[str], instance: Instance) -> str:
    """A connector's kind; empty for variables that have none. An input that nothing drives would be set to
    zero by some tools if it were shown."""
    if not variable.numeric or variable.variability == "constant":
        return ""
    if variable.causality == "input":
        return "input" if f"{name}.{variable.name}" in driven else ""
    return {"output": "output", "parameter": "parameter"}.get(variable.causality, "")


def _write_type(
    connector: Any, variable: Variable, quantity: Quantity | None, enumerations: dict[str, tuple[str, ...]]
) -> None:
    if variable.type in REALS:
        add_element(connector, "ssc:Real", unit=variable.unit or None)
    elif variable.type in BOOLEANS:
        add_element(connector, "ssc:Boolean")
    elif quantity is not None and quantity.choices:
        enumerations[variable.name] = quantity.choices
        add_element(connector, "ssc:Enumeration", name=variable.name)
    else:
        add_element(connector, "ssc:Integer")


def _write_connection(parent: Any, text: str) -> None:
    line = parse_line(text)
    changed = line.factor is not None or line.offset is not None
    (start, out), (end, into) = (port.split(".", 1) for port in (line.source, line.target))
    connection = add_element(
        parent,
        "ssd:Connection",
        startElement=start,
        startConnector=out,
        endElement=end,
        endConnector=into,
        suppressUnitConversion=True if changed else None,
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
        for key in ("parameters", "start", "inputs"):
            table.pop(key, None)
        if table["participant"].endswith(".fmu"):
            del table["participant"]
        else:
            table["sha256"] = fmus[name].sha256
    return content
