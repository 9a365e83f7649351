"""A participant that wraps another and has numbers of its own to save with the other's state."""

from __future__ import annotations

from typing import Any

import numpy as np

from models.core.quantities import Vector

from .wrapping import ParticipantWrapper


class StatefulWrapper(ParticipantWrapper):
    """Saves and restores the vector `_own` beside the state of `participant`.

    To be completed with connect, write, advance, read, read_all.
    """

    _own: Vector

    def save(self) -> tuple[Any, Vector]:
        return self._participant.save(), self._own.copy()

    def restore(self, saved: tuple[Any, Vector]) -> None:
        self._participant.restore(saved[0])
        self._own[:] = saved[1]

    def release(self, saved: tuple[Any, Vector]) -> None:
        self._participant.release(saved[0])

    def to_bytes(self, saved: tuple[Any, Vector]) -> bytes:
        return saved[1].tobytes() + self._participant.to_bytes(saved[0])

    def from_bytes(self, data: bytes) -> tuple[Any, Vector]:
        size = self._own.nbytes
        return self._participant.from_bytes(data[size:]), np.frombuffer(data[:size]).copy()
