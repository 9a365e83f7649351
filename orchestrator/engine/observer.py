"""What watches a run."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

from models.core.quantities import Vector

from ..store.json_codec import Plain
from .step import Step

if TYPE_CHECKING:
    from .coupling import Coupling


class Observer(ABC):
    """Watches a run; algorithms never write files. What an observer leaves out does nothing.

    `watch` and `attach` are called first, of all observers; then `begin`, or `resume` in its place.
    """

    def watch(self, coupling: Coupling) -> None:
        """What is exchanged and single participants, for who reads them."""
        return

    def attach(self, state: Callable[[], dict[str, Plain]]) -> None:
        """`state()`, called inside `observe`, is the run's evolving data; what observers before this one have
        recorded is in it."""
        return

    def begin(self, names: Sequence[str]) -> None:
        """Before the first values: the names of all outputs, "participant.variable"."""
        return

    @abstractmethod
    def observe(self, time: float, outputs: Callable[[], Vector], step: Step) -> None:
        """At the start (a step of no length) and after each macro step.

        `outputs()` gives all outputs at `time`, in memory that is reused. They are read when the first
        observer asks: a step that nobody records costs no reading.
        """

    def end(self, complete: bool, message: str) -> None:
        """After the last values, also when the run failed or was interrupted."""
        return

    def state(self) -> Plain:
        """Its evolving data; files are on the disk up to here."""
        return None

    def resume(self, names: Sequence[str], state: Plain) -> None:
        """Go on from `state`, forgetting what came after it."""
        self.begin(names)


def is_recorded(count: int, time: float, every: int, stop: float) -> bool:
    """Whether macro step number `count`, ending at `time` (s), is recorded: every n-th and the last."""
    return count % every == 0 or time >= stop
