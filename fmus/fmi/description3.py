"""modelDescription.xml of FMI 3.0, from the same metadata as that of FMI 2.0, for native FMUs.

Vectors that no tool connects are arrays (`arrays`), with the reference of their first element.
"""

from collections.abc import Iterable, Mapping
from typing import Any
from xml.etree.ElementTree import Element, SubElement

from ..variable_layout import Memory, Variable
from .arrays import ArrayVariable, group_arrays
from .description import (
    GUID_PLACE,
    Experiment,
    Origin,
    about,
    dependencies,
    items,
    naming_attributes,
    running,
    structure,
    to_xml,
    types,
    unit_attributes,
    units,
    value_attributes,
)

_TYPES = {"Real": "Float64", "Integer": "Int32", "Boolean": "Boolean", "Enumeration": "Enumeration"}

_BOTH = {
    "needsExecutionTool": "false",
    "canBeInstantiatedOnlyOncePerProcess": "false",
    "canGetAndSetFMUState": "true",
    "canSerializeFMUState": "true",
    "providesDirectionalDerivatives": "true",
    "providesAdjointDerivatives": "true",
    "providesPerElementDependencies": "false",
}
EXCHANGE = _BOTH | {"needsCompletedIntegratorStep": "true", "providesEvaluateDiscreteStates": "false"}
CO_SIMULATION = _BOTH | {
    "canHandleVariableCommunicationStepSize": "true",
    "maxOutputDerivativeOrder": "1",
    "providesIntermediateUpdate": "true",
    "canReturnEarlyAfterIntermediateUpdate": "true",
    "hasEventMode": "true",
    "providesEvaluateDiscreteStates": "false",
}


def model_description(component: Any, model_name: str, experiment: Experiment, origin: Origin) -> str:
    """The XML text, with `GUID_PLACE` where the instantiation token belongs."""
    memory = Memory(component)
    described = (*memory.variables(), *memory.motion())
    variables = (memory.time(), *described, *memory.indicators())
    root = Element(
        "fmiModelDescription", fmiVersion="3.0", modelName=model_name, instantiationToken=GUID_PLACE
    )
    root.attrib |= about(component, origin)
    SubElement(root, "ModelExchange", {"modelIdentifier": model_name, **EXCHANGE})
    events = {"mightReturnEarlyFromDoStep": "true" if component.event_counter else "false"}
    SubElement(root, "CoSimulation", {"modelIdentifier": model_name, **CO_SIMULATION, **events})
    units(root, variables)
    _types(SubElement(root, "TypeDefinitions"), types(variables))
    running(root, experiment)
    listed = SubElement(root, "ModelVariables")
    declared = group_arrays(variables)
    for one in declared:
        _variable(listed, one)
    # Of each element the reference of its array.
    array = {element.reference: one.first.reference for one in declared for element in one.elements}
    unknowns = structure(component, described)
    parts = {
        "Output": unknowns.outputs,
        "ContinuousStateDerivative": unknowns.derivatives,
        "InitialUnknown": unknowns.at_start,
        "EventIndicator": dict.fromkeys((v.reference for v in memory.indicators()), unknowns.indicators),
    }
    made = SubElement(root, "ModelStructure")
    for name, calculated in parts.items():
        for reference, through in _whole(calculated, array).items():
            SubElement(made, name, {"valueReference": str(reference), **dependencies(through)})
    return to_xml(root)


def _whole(calculated: Mapping[int, Iterable[int]], array: Mapping[int, int]) -> dict[int, list[int]]:
    """The same of arrays, which depend on all that one of their elements depends on."""
    found: dict[int, list[int]] = {}
    for reference, through in calculated.items():
        before = found.get(array[reference], [])
        found[array[reference]] = list(dict.fromkeys([*before, *(array[other] for other in through)]))
    return found


def _types(parent: Element, examples: Mapping[str, Variable]) -> None:
    for name, variable in examples.items():
        if variable.kind == "Real":
            SubElement(parent, "Float64Type", {"name": name, **unit_attributes(variable)})
        else:
            items(SubElement(parent, "EnumerationType", name=name), variable)


def _variable(parent: Element, declared: ArrayVariable) -> None:
    variable = declared.first
    attributes = naming_attributes(variable, declared.name)
    if variable.variability == "continuous" and variable.causality != "independent":
        attributes["intermediateUpdate"] = "true"  # what a host may set or read in the course of a step
    attributes |= value_attributes(variable)
    if "start" in attributes:
        attributes["start"] = " ".join(value_attributes(v)["start"] for v in declared.elements)
    if variable.rate_of is not None:
        attributes["derivative"] = str(variable.rate_of)
    if variable.jumps:
        attributes["reinit"] = "true"
    element = SubElement(parent, _TYPES[variable.kind], attributes)
    if declared.array:
        SubElement(element, "Dimension", start=str(len(declared.elements)))
