"""modelDescription.xml of a component, generated from the metadata of its quantities."""

import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any
from xml.etree.ElementTree import Element, SubElement, indent, tostring

from ..variable_layout import Memory, Variable
from .units import base, display_factor, per_second

LOG_CATEGORIES = {
    "logStatusWarning": "Warnings",
    "logStatusDiscard": "Steps that were discarded",
    "logStatusError": "Errors: what is wrong, its value and its allowed range",
    "logStatusFatal": "Errors after which the instance must not be used",
    "logAll": "All messages",
}

# Of an FMU that runs in Python.
PYTHON = {
    "needsExecutionTool": "true",
    "canHandleVariableCommunicationStepSize": "true",
    "canInterpolateInputs": "false",
    "maxOutputDerivativeOrder": "0",
    "canBeInstantiatedOnlyOncePerProcess": "false",
    "canNotUseMemoryManagementFunctions": "true",
    "canGetAndSetFMUstate": "true",
    "canSerializeFMUstate": "true",
    "providesDirectionalDerivative": "false",
}
# Of one that needs nothing but itself, and of the same where the host integrates.
NATIVE = PYTHON | {
    "needsExecutionTool": "false",
    "canInterpolateInputs": "true",
    "maxOutputDerivativeOrder": "1",
    "providesDirectionalDerivative": "true",
}

EXCHANGE = {
    "needsExecutionTool": "false",
    "completedIntegratorStepNotNeeded": "false",
    "canBeInstantiatedOnlyOncePerProcess": "false",
    "canNotUseMemoryManagementFunctions": "true",
    "canGetAndSetFMUstate": "true",
    "canSerializeFMUstate": "true",
    "providesDirectionalDerivative": "true",
}

# A name by the convention "structured", in which other letters need quotes.
_STRUCTURED = re.compile(r"[A-Za-z_]\w*(\.[A-Za-z_]\w*)*(\[\d+\])?", re.ASCII)

GUID_PLACE = "{guid}"


@dataclass(frozen=True)
class Experiment:
    """What a tool offers to run first."""

    stop_time: float
    step_size: float
    start_time: float = 0.0
    tolerance: float = 1e-6


@dataclass(frozen=True)
class Origin:
    """Who made it, by which licence, in which version, with which tool."""

    author: str
    copyright: str
    license: str
    version: str
    tool: str


def model_description(
    component: Any,
    model_name: str,
    experiment: Experiment,
    origin: Origin,
    abilities: Mapping[str, str],
    exchange: Mapping[str, str] | None = None,
) -> str:
    """The XML text, with `GUID_PLACE` where the guid belongs.

    `abilities` in co-simulation, and in model exchange, where that is possible.
    """
    memory = Memory(component)
    variables = (*memory.variables(), *(memory.motion() if exchange else ()))
    index = {v.reference: i for i, v in enumerate(variables, 1)}
    root = Element("fmiModelDescription", fmiVersion="2.0", modelName=model_name, guid=GUID_PLACE)
    root.attrib |= about(component, origin)
    root.set("numberOfEventIndicators", str(component.events.count if exchange and component.events else 0))
    if exchange:
        SubElement(root, "ModelExchange", {"modelIdentifier": model_name, **exchange})
    SubElement(root, "CoSimulation", {"modelIdentifier": model_name, **abilities})
    units(root, variables)
    _types(SubElement(root, "TypeDefinitions"), variables)
    running(root, experiment)
    listed = SubElement(root, "ModelVariables")
    for variable in variables:
        _scalar(listed, variable, index)
    _structure(SubElement(root, "ModelStructure"), structure(component, variables), index)
    return to_xml(root)


def about(component: Any, origin: Origin) -> dict[str, str]:
    """Attributes that say what it is and whose."""
    layouts = component.parameters, component.state, component.inputs, component.outputs
    fits = all(_STRUCTURED.fullmatch(name) for layout in layouts for name in layout.names)
    return {
        "description": component.description,
        "author": origin.author,
        "version": origin.version,
        "copyright": origin.copyright,
        "license": origin.license,
        "generationTool": origin.tool,
        "variableNamingConvention": "structured" if fits else "flat",
    }


def running(root: Element, experiment: Experiment) -> None:
    """Add log categories and default experiment."""
    categories = SubElement(root, "LogCategories")
    for name, text in LOG_CATEGORIES.items():
        SubElement(categories, "Category", name=name, description=text)
    SubElement(
        root,
        "DefaultExperiment",
        startTime=_number(experiment.start_time),
        stopTime=_number(experiment.stop_time),
        tolerance=_number(experiment.tolerance),
        stepSize=_number(experiment.step_size),
    )


def to_xml(root: Element) -> str:
    """The XML file."""
    indent(root)
    return '<?xml version="1.0" encoding="UTF-8"?>\n' + tostring(root, encoding="unicode") + "\n"


def full_unit(variable: Variable) -> str:
    return per_second(variable.unit, variable.derivative_order)


def display_unit(variable: Variable) -> str:
    quantity = variable.quantity
    return quantity.display_unit if quantity is not None and not variable.derivative_order else ""


def type_name(variable: Variable) -> str:
    """Name of the declared type."""
    if variable.kind == "Enumeration":
        return f"choice of {', '.join(variable.quantity.choices)}"
    shown = display_unit(variable)
    return f"quantity in {full_unit(variable)}" + (f", shown in {shown}" if shown else "")


def _number(value: float) -> str:
    """Shortest text that reads back as the same double."""
    return repr(float(value))


def units(root: Element, variables: Sequence[Variable]) -> None:
    """Add the definitions of units that the variables have."""
    parent = SubElement(root, "UnitDefinitions")
    shown: dict[str, set[str]] = {}
    for variable in variables:
        if variable.kind == "Real" and variable.unit:
            shown.setdefault(full_unit(variable), set()).update(filter(None, [display_unit(variable)]))
    for unit in sorted(shown):
        factor, exponents = base(unit)
        entry = SubElement(parent, "Unit", name=unit)
        attributes = {name: str(power) for name, power in exponents.items()}
        if factor != 1.0:
            attributes["factor"] = _number(factor)
        SubElement(entry, "BaseUnit", attributes)
        for display in sorted(shown[unit]):
            SubElement(entry, "DisplayUnit", name=display, factor=_number(display_factor(unit, display)))


def types(variables: Sequence[Variable]) -> dict[str, Variable]:
    """A variable of each declared type, by the type's name."""
    examples = {type_name(v): v for v in variables if v.unit and v.kind in ("Real", "Enumeration")}
    return dict(sorted(examples.items()))


def _types(parent: Element, variables: Sequence[Variable]) -> None:
    for name, variable in types(variables).items():
        simple = SubElement(parent, "SimpleType", name=name)
        if variable.kind == "Real":
            SubElement(simple, "Real", unit_attributes(variable))
        else:
            items(SubElement(simple, "Enumeration"), variable)


def items(parent: Element, variable: Variable) -> None:
    """Add the choices of an enumeration."""
    for value, choice in enumerate(variable.quantity.choices):
        SubElement(parent, "Item", name=choice, value=str(value))


def unit_attributes(variable: Variable) -> dict[str, str]:
    attributes = {"unit": full_unit(variable)}
    if shown := display_unit(variable):
        attributes["displayUnit"] = shown
    return attributes


def _scalar(parent: Element, variable: Variable, index: Mapping[int, int]) -> None:
    element = SubElement(parent, "ScalarVariable", naming_attributes(variable, variable.name))
    attributes = value_attributes(variable)
    if variable.rate_of is not None:
        attributes["derivative"] = str(index[variable.rate_of])
    if variable.jumps:
        attributes["reinit"] = "true"
    SubElement(element, variable.kind, attributes)


def naming_attributes(variable: Variable, name: str) -> dict[str, str]:
    """What both versions say of a variable of this name before its values."""
    attributes = {
        "name": name,
        "valueReference": str(variable.reference),
        "description": variable.description,
        "causality": variable.causality,
        "variability": variable.variability,
    }
    if variable.causality in ("output", "local"):
        attributes["initial"] = "calculated"
    elif variable.causality == "parameter":
        attributes["initial"] = "exact"
    return attributes


def value_attributes(variable: Variable) -> dict[str, str]:
    """Type, unit, range, nominal and start value."""
    attributes: dict[str, str] = {}
    quantity = variable.quantity
    whole = variable.kind != "Real"
    if variable.unit and variable.kind in ("Real", "Enumeration"):
        attributes["declaredType"] = type_name(variable)
    if variable.unit and variable.kind == "Real":
        attributes |= unit_attributes(variable)
    if variable.kind in ("Real", "Integer") and quantity is not None:
        low = max(quantity.minimum, 0.0) if quantity.positive else quantity.minimum
        for key, limit in (("min", low), ("max", quantity.maximum)):
            if math.isfinite(limit):
                attributes[key] = str(int(limit)) if whole else _number(limit)
    if variable.kind == "Enumeration":
        attributes |= {"min": "0", "max": str(len(quantity.choices) - 1)}
    if variable.kind == "Real" and quantity is not None and quantity.nominal != 1.0:
        attributes["nominal"] = _number(quantity.nominal)
    if variable.start is not None:
        if variable.kind == "Boolean":
            attributes["start"] = "true" if variable.start else "false"
        else:
            attributes["start"] = str(int(variable.start)) if whole else _number(variable.start)
    return attributes


@dataclass(frozen=True)
class Unknowns:
    """What is calculated, by value references, and from which others."""

    outputs: Mapping[int, list[int]]
    derivatives: Mapping[int, list[int]]
    at_start: Mapping[int, list[int]]
    indicators: list[int]


def structure(component: Any, variables: Sequence[Variable]) -> Unknowns:
    """Outputs depend on the inputs that their feedthrough names and, at the start, on the parameters;
    derivatives on all states and inputs, which some hosts want to read.

    A rate goes along with the state, whose derivative may depend on every input, and with the slopes of the
    inputs that its output names.
    """
    inputs = {v.name: v.reference for v in variables if v.causality == "input"}
    names = {v.reference: v.name for v in variables}
    given = [v.reference for v in variables if v.causality == "parameter"]
    rates = {v.reference: v.rate_of for v in variables if v.causality == "local" and v.rate_of is not None}
    states = list(rates.values())
    known: dict[int, list[int]] = {}
    for variable in (v for v in variables if v.causality == "output"):
        if variable.rate_of is None:
            through = component.feedthrough.get(variable.name, ())
        else:
            direct = component.feedthrough.get(names[variable.rate_of], ())
            slopes = (component.inputs.field(name).add_suffix("_der1") for name in direct)
            through = (*component.inputs.names, *slopes)
        known[variable.reference] = sorted(inputs[name] for name in through)
    every = [inputs[name] for name in component.inputs.names]
    return Unknowns(
        outputs={y: through + states for y, through in known.items()},
        derivatives=dict.fromkeys(rates, states + every),
        indicators=states + every,
        at_start={y: given + through for y, through in known.items()}
        | dict.fromkeys(sorted([*states, *rates]), given + every),
    )


def dependencies(from_which: Sequence[int]) -> dict[str, str]:
    """Attributes of what is calculated from these."""
    kinds = " ".join(["dependent"] * len(from_which))
    return {"dependencies": " ".join(map(str, from_which)), "dependenciesKind": kinds}


def _structure(parent: Element, unknowns: Unknowns, place: Mapping[int, int]) -> None:
    parts = {
        "Outputs": unknowns.outputs,
        "Derivatives": unknowns.derivatives,
        "InitialUnknowns": unknowns.at_start,
    }
    for name, calculated in parts.items():
        if not calculated and name != "Outputs":
            continue
        listed = SubElement(parent, name)
        for reference, through in calculated.items():
            by = dependencies([place[r] for r in through])
            SubElement(listed, "Unknown", {"index": str(place[reference]), **by})
