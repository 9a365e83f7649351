"""A participant that wraps another and has no state of its own."""

from __future__ import annotations

from typing import Any

from .protocol import Participant


class Wrapping:
    """Passes on what does not concern it to `participant`.

    To be completed to a `Participant` with what it does otherwise: connect, write, advance, read. What isn't
    changed are the participant's own functions, not methods around them.
    """

    def __init__(self, participant: Participant) -> None:
        self.name = participant.name
        self.restorable = participant.restorable
        self._participant = participant
        self.initialise = participant.initialise
        self.finish_initialisation = participant.finish_initialisation
        self.read_all = participant.read_all
        self.save = participant.save
        self.restore = participant.restore
        self.release = participant.release
        self.close = participant.close

    def to_bytes(self, saved: Any) -> bytes:
        return self._participant.to_bytes(saved)

    def from_bytes(self, data: bytes) -> Any:
        return self._participant.from_bytes(data)
