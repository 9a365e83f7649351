"""What watches a run."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Protocol, runtime_checkable

from models.core.quantities import Vector

from .step import Step

if TYPE_CHECKING:
    from .coupling import Coupling


class Observer(Protocol):
    """Watches a run; algorithms never write files. One that inherits from it begins and ends with nothing."""

    def begin(self, names: Sequence[str]) -> None:
        """Before the first values: the names of all outputs, "participant.variable"."""
        return

    def observe(self, time: float, outputs: Callable[[], Vector], step: Step) -> None:
        """At the start (a step of no length) and after each macro step.

        `outputs()` gives all outputs at `time`, in memory that is reused. They are read when the first
        observer asks: a step that nobody records costs no reading.
        """
        ...

    def end(self, complete: bool, message: str) -> None:
        """After the last values, also when the run failed or was interrupted."""
        return


@runtime_checkable
class Watching(Protocol):
    """An observer that reads what is exchanged and single participants itself."""

    def watch(self, coupling: Coupling) -> None:
        """Before `begin`."""
        ...


def is_recorded(count: int, time: float, every: int, stop: float) -> bool:
    """Whether macro step number `count`, ending at `time` (s), is recorded: every n-th and the last."""
    return count % every == 0 or time >= stop
