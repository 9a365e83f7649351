"""What fmpy does not read of descriptions of FMI 1.0."""

from typing import Any
from xml.etree import ElementTree

from fmpy.model_description import Unknown

CAPABILITIES = (
    "canHandleVariableCommunicationStepSize", "canInterpolateInputs", "canBeInstantiatedOnlyOncePerProcess",
)  # fmt: skip


def complete(found: Any, root: ElementTree.Element) -> None:
    """Complete fmpy's description, which is of FMI 1.0: capabilities and dependencies.

    Only co-simulation is left. Variables that are the negative of another are left out: their references
    would give the other's value.
    """
    stated = {one.get("name"): one for one in root.iter("ScalarVariable")}
    found.modelExchange = None
    found.modelVariables = [v for v in found.modelVariables if stated[v.name].get("alias") != "negatedAlias"]
    known = {v.name: v for v in found.modelVariables}
    for variable in found.modelVariables:
        if (
            variable.causality == "local"
            and variable.start is not None
            and variable.variability != "constant"
        ):
            variable.initial = "approx"
        depends = stated[variable.name].find("DirectDependency")
        if variable.causality == "output" and depends is not None:
            inputs = [known[name.text] for name in depends.iter("Name") if name.text in known]
            found.outputs.append(Unknown(variable=variable, dependencies=inputs))
    abilities = root.find("Implementation/*/Capabilities")
    if found.coSimulation is not None and abilities is not None:
        for name in CAPABILITIES:
            setattr(found.coSimulation, name, abilities.get(name) in ("true", "1"))
