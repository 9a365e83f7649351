"""Participants that wrap another."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from .protocol import Participant


class ParticipantWrapper:
    """Passes on to `participant` what no wrapping concerns.

    To be completed to a `Participant` with what it does otherwise. What isn't changed are the participant's
    own functions, not methods around them.
    """

    def __init__(self, participant: Participant) -> None:
        self.name = participant.name
        self.restorable = participant.restorable
        self._participant = participant
        self.initialise = participant.initialise
        self.finish_initialisation = participant.finish_initialisation
        self.close = participant.close

    def signal_degrees(self, input_names: Sequence[str]) -> Sequence[int]:
        return self._participant.signal_degrees(input_names)


class StatelessWrapper(ParticipantWrapper):
    """Has no state of its own. To be completed with connect, write, advance, read."""

    def __init__(self, participant: Participant) -> None:
        super().__init__(participant)
        self.read_all = participant.read_all
        self.save = participant.save
        self.restore = participant.restore
        self.release = participant.release

    def to_bytes(self, saved: Any) -> bytes:
        return self._participant.to_bytes(saved)

    def from_bytes(self, data: bytes) -> Any:
        return self._participant.from_bytes(data)
