"""Coupling that nearly preserves energy: what efforts and flows missed comes back in the next step.

Benedikt, Watzenig, Zehetner and Hofer 2013 (NEPCE, Coupled Problems 2013): over a step an input's
polynomial misses the true signal by an area; with the next step's input raised by this area over the step,
the integral of the input over time is right to one order more, and the coupling creates less energy. The
order of the whole stays that of the signals where exchanged outputs depend directly on inputs.

The missed signal begins with zero and grows with s^(k+1) for a polynomial of degree k: its area is the value
that it misses at the end, times the step over k + 2.
"""

from collections.abc import Sequence
from typing import NoReturn

import numpy as np

from models.core.component import Component

from ...participants.compiled_calls import NotCompiledError
from ...participants.protocol import BoundVariables, Participant
from ...participants.wrapping import StatefulWrapper


def bond_inputs(component: Component) -> list[str]:
    """The inputs that are efforts or flows of power bonds."""
    variables = dict.fromkeys(v for bond in component.bonds for v in (bond.effort, bond.flow))
    return [v for v in variables if v in component.inputs]


class Compensated(StatefulWrapper):
    """Implements `Participant` by `participant`, with the inputs `corrected` made up for what they missed.

    For Jacobi masters, which extrapolate every input.
    """

    def __init__(self, participant: Participant, corrected: Sequence[str]) -> None:
        super().__init__(participant)
        self._corrected = set(corrected)
        self.read_all = participant.read_all

    def compiled_calls(self) -> NoReturn:
        raise NotCompiledError("[energy] corrects its inputs")

    def connect(self, bound: BoundVariables) -> Sequence[bool]:
        self._given, self._used = bound.inputs, bound.inputs.copy()
        names = enumerate(bound.input_names)
        self._columns = np.array([i for i, name in names if name in self._corrected], dtype=int)
        # Where the last step's polynomials ended; nan before the first step.
        self._own = np.full(len(self._columns), np.nan)
        rated = self._participant.connect(bound._replace(inputs=self._used))
        self.read = self._participant.read
        return rated

    def write(self) -> None:
        self._used[:] = self._given
        missed = self._given[0, self._columns] - self._own
        degree = len(self._given) - 1
        self._used[0, self._columns] += np.nan_to_num(missed, nan=0.0) / (degree + 2)
        self._participant.write()

    def advance(self, time: float, step: float) -> None:
        self._participant.advance(time, step)
        powers = np.cumprod([1.0, *(step / k for k in range(1, len(self._given)))])
        self._own[:] = powers @ self._given[:, self._columns]
