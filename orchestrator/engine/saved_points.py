"""Points of a coupled run to go back to: the participants' states and the state of the coupling."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

from ..participants.protocol import Participant
from .coupling_state import CouplingState


@dataclass(frozen=True)
class SavedPoint:
    """The participants' states by number, and that of the coupling."""

    participants: Mapping[int, Any]
    coupling: CouplingState


class SavedPoints:
    """Saves the present point, once as long as nobody moves."""

    def __init__(self, participants: Sequence[Participant], state: CouplingState) -> None:
        self._participants, self._state = participants, state
        self.present: SavedPoint | None = None  # the saved point at which everybody is

    def save(self) -> SavedPoint:
        """The present point; to be released."""
        if self.present is None:
            states = {i: participant.save() for i, participant in enumerate(self._participants)}
            self.present = SavedPoint(states, self._state.copy())
        return self.present

    def restore(self, point: SavedPoint) -> None:
        """Back to a saved point, bit for bit."""
        for i, state in point.participants.items():
            self._participants[i].restore(state)
        self._state.assign(point.coupling)
        self.present = point

    def release(self, point: SavedPoint) -> None:
        """Free what the participants keep for a point."""
        for i, state in point.participants.items():
            self._participants[i].release(state)
        if self.present is point:
            self.present = None

    @contextmanager
    def keep(self) -> Iterator[SavedPoint]:
        """The present point, saved as long as the block lasts; within another such block at no cost."""
        before, point = self.present, self.save()
        try:
            yield point
        finally:
            if before is None:
                self.release(point)

    @contextmanager
    def rollback(self, part: Sequence[int]) -> Iterator[Callable[[], None]]:
        """Inside the block, a function that returns the participants in `part` to where they are now.

        The state of the coupling is left alone.
        """
        units = self._participants
        own = {} if self.present else {i: units[i].save() for i in part}
        states = self.present.participants if self.present else own

        def roll_back() -> None:
            for i in part:
                units[i].restore(states[i])

        try:
            yield roll_back
        finally:
            for i, state in own.items():
                units[i].release(state)
