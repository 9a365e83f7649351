"""One participant by itself, in process or as an FMU, of which one input is given."""

from collections.abc import Sequence

import numpy as np

from orchestrator.participants.protocol import BoundVariables, Participant


class Alone:
    """A participant, its input and what it shows; `start` is the input's value at first."""

    def __init__(self, unit: Participant, name: str, outputs: Sequence[str], start: float) -> None:
        self.unit = unit
        self._inputs, self._outputs = np.zeros((2, 1)), np.zeros(len(outputs))
        unit.connect(BoundVariables([name], self._inputs, list(outputs), self._outputs, np.zeros(0)))
        self._inputs[0] = start
        unit.initialise(0.0, 1.0)
        unit.write()
        unit.finish_initialisation()

    def saved(self) -> bytes:
        kept = self.unit.save()
        try:
            return self.unit.to_bytes(kept)
        finally:
            self.unit.release(kept)

    def advance(self, time: float, step: float, value: float, rate: float = 0.0) -> list[float]:
        self._inputs[:, 0] = value, rate
        self.unit.write()
        self.unit.advance(time, step)
        self.unit.read()
        return self._outputs.tolist()
