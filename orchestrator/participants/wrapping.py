"""Participants that wrap another: their base class, and one whose inputs are transformed (units, gains)."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from .compiled_calls import CompiledCalls
from .protocol import Abilities, BoundVariables, Participant


class ParticipantWrapper:
    """Passes calls on to `participant` and has no state of its own. A subclass adds connect, compiled_calls,
    write, advance and read.

    Calls that stay the same are the participant's own functions, without a method around them.
    """

    def __init__(self, participant: Participant) -> None:
        self.name = participant.name
        self._participant = participant
        self.initialise = participant.initialise
        self.finish_initialisation = participant.finish_initialisation
        self.set_inputs = participant.set_inputs
        self.read_all = participant.read_all
        self.save = participant.save
        self.restore = participant.restore
        self.release = participant.release
        self.close = participant.close

    @property
    def abilities(self) -> Abilities:
        return self._participant.abilities

    def signal_degrees(self, input_names: Sequence[str]) -> Sequence[int]:
        return self._participant.signal_degrees(input_names)

    def to_bytes(self, saved: Any) -> bytes:
        return self._participant.to_bytes(saved)

    def from_bytes(self, data: bytes) -> Any:
        return self._participant.from_bytes(data)


@dataclass(frozen=True)
class Linear:
    """factor * value + offset."""

    factor: float = 1.0
    offset: float = 0.0


class Transformed(ParticipantWrapper):
    """Implements `Participant` by `participant`, with `transformations` of inputs, by name."""

    def __init__(self, participant: Participant, transformations: Mapping[str, Linear]) -> None:
        super().__init__(participant)
        self._transformations = transformations
        self.advance = participant.advance

    def connect(self, bound: BoundVariables) -> Sequence[bool]:
        none = Linear()
        own = [self._transformations.get(name, none) for name in bound.input_names]
        self._factors = np.array([linear.factor for linear in own])
        self._offsets = np.array([linear.offset for linear in own])
        self._given, self._made = bound.inputs, np.zeros_like(bound.inputs)
        rated = self._participant.connect(bound._replace(inputs=self._made))
        self.read, self._write = self._participant.read, self._participant.write
        return rated

    def compiled_calls(self) -> CompiledCalls:
        calls = self._participant.compiled_calls()
        rows, columns = calls.picked

        def fail(call: int, status: int, time: float, step: float) -> None:
            self._transform()
            calls.fail(call, status, time, step)

        return replace(
            calls,
            factors=calls.factors * self._factors[columns],
            offsets=calls.factors * np.where(rows == 0, self._offsets[columns], -0.0) + calls.offsets,
            fail=fail,
        )

    def _transform(self) -> None:
        np.multiply(self._given, self._factors, out=self._made)
        self._made[0] += self._offsets

    def write(self) -> None:
        self._transform()
        self._write()
