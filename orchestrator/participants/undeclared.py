"""Outputs that depend on an input at once, though the description says that they don't."""

from collections.abc import Iterator

import numpy as np

from models.core.component import Component

from .protocol import Participant

# Relative to nominal + |value|, by which outputs of one state and the same inputs may differ.
ROUNDING = 1e-12


def list_undeclared(participant: Participant, component: Component) -> Iterator[tuple[str, str]]:
    """Pairs of output and input, found by other values of each input, of which the outputs go back to the
    start value. Inputs that change at events only are left out."""
    outputs, names = component.outputs, np.array(component.outputs.names)
    fields = [field for field in component.inputs.fields if not field.quantity.jumps]
    participant.set_inputs({field.name: field.start for field in fields})
    before, now = np.zeros(outputs.size), np.zeros(outputs.size)
    for field in fields:
        participant.read_all(before)
        participant.set_inputs({field.name: field.quantity.displace(field.start)})
        participant.read_all(now)
        participant.set_inputs({field.name: field.start})
        for name in names[np.abs(now - before) > ROUNDING * (outputs.nominal + np.abs(before))]:
            if field.name not in component.feedthrough.get(str(name), ()):
                yield str(name), field.name
