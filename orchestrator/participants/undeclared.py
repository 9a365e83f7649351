"""Outputs that depend on an input at once, though the description says that they don't."""

from collections.abc import Iterator, Mapping

import numpy as np

from models.core.component import Component

from .protocol import Participant

# Relative to nominal + |value|, by which outputs of one state and the same inputs may differ.
ROUNDING = 1e-12


def describe_undeclared(
    participant: Participant, component: Component, inputs: Mapping[str, float]
) -> Iterator[str]:
    """A sentence for each output and input, found by other values of each of these inputs, which then have
    theirs again. Inputs that change at events only are left out."""
    outputs, names = component.outputs, np.array(component.outputs.names)
    quantities = {name: component.inputs.field(name).quantity for name in inputs}
    given = {name: value for name, value in inputs.items() if not quantities[name].jumps}
    participant.set_inputs(given)
    before, now = np.zeros(outputs.size), np.zeros(outputs.size)
    for name, value in given.items():
        participant.read_all(before)
        participant.set_inputs({name: quantities[name].displace(value)})
        participant.read_all(now)
        participant.set_inputs({name: value})
        for output in names[np.abs(now - before) > ROUNDING * (outputs.nominal + np.abs(before))]:
            if name not in component.feedthrough.get(str(output), ()):
                yield (
                    f"{output} depends on {name} at the same instant, but its dependencies in ModelStructure "
                    "do not say so, and it may be computed before that input; have modelDescription.xml "
                    "corrected"
                )
