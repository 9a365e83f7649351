"""Sends points to workers and receives their outcomes."""

import pickle
import time as clock
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import CancelledError
from contextlib import suppress
from dataclasses import dataclass
from itertools import islice
from typing import Any

from distributed import Client, Future, as_completed
from distributed.scheduler import KilledWorker

from models.core.interruption import look

from ..errors import RunError
from .points import Points
from .subjects import Subject
from .task import Outcome, evaluate

# Points submitted for each thread: enough that none waits while outcomes are written.
AHEAD = 4

# An empty batch comes after so long without an outcome, so that progress can be shown. Looks for outcomes are
# so far apart: at first the shortest, each time twice as far.
WAIT_S, SHORTEST_LOOK_S, LONGEST_LOOK_S = 1.0, 0.002, 0.1

DIED = "the worker's process died at this point, more than once (out of memory, or a crash in compiled code)"


class WorkerError(RunError):
    """A worker lacks our source or libraries, or the scheduler has ended."""


@dataclass(frozen=True)
class Call:
    """Unpickles to the result of `function`.

    A worker without our packages would end on receiving one of our functions. Any worker can unpickle, and
    returns a missing package as an error.
    """

    function: Callable[..., Any]
    arguments: tuple[Any, ...]

    def __reduce__(self) -> tuple[Callable[..., Any], tuple[Any, ...]]:
        return self.function, self.arguments


class Execution:
    """Evaluates points of a study on a cluster."""

    def __init__(self, client: Client, subject: Subject, points: Points, versions: dict[str, str]) -> None:
        self._client = client
        self._scheduler = client.scheduler_info()["address"]
        self._subject = subject
        self._points = points
        self._versions = versions

    def outcomes(self, indices: Sequence[int]) -> Iterator[list[tuple[int, Outcome]]]:
        """The outcomes of these points, in batches, in the order in which they arrive.

        If a worker dies, its points go to another one. A point that was on more than DEATHS dead workers is
        evaluated again alone; if it kills that worker too, it fails with the message DIED.
        """
        try:
            yield from self._evaluate(indices)
        except (OSError, CancelledError):
            raise WorkerError(
                f"the scheduler at {self._scheduler} is gone; what is finished is kept, the same command "
                "continues"
            ) from None

    def _evaluate(self, indices: Sequence[int]) -> Iterator[list[tuple[int, Outcome]]]:
        suspects: list[int] = []
        for batch in self._complete(indices, ahead=AHEAD):
            suspects += [index for index, outcome in batch if outcome is None]
            yield [(index, outcome) for index, outcome in batch if outcome is not None]
        for index in sorted(suspects):
            for batch in self._complete([index], ahead=1):
                yield [(index, outcome or Outcome({}, DIED)) for index, outcome in batch]

    def _complete(self, indices: Sequence[int], ahead: int) -> Iterator[list[tuple[int, Outcome | None]]]:
        """Outcomes, None for points whose workers died; an empty batch whenever there is none for a while."""
        waiting = iter(indices)
        numbers: dict[Future, int] = {}
        completed = as_completed()
        try:
            self._submit(islice(waiting, self._count_slots(ahead)), numbers, completed)
            while numbers:
                batch = wait_for_some(completed)
                yield [(numbers.pop(future), self._read_outcome(future)) for future in batch]
                self._submit(
                    islice(waiting, max(0, self._count_slots(ahead) - len(numbers))), numbers, completed
                )
        finally:
            with suppress(OSError, CancelledError):
                self._client.cancel(list(numbers))

    def _count_slots(self, ahead: int) -> int:
        return max(1, ahead * sum(self._client.nthreads().values()))

    def _submit(self, indices: Iterator[int], numbers: dict[Future, int], completed: as_completed) -> None:
        for index in indices:
            values = self._points[index]
            call = pickle.dumps(Call(evaluate, (self._subject, values, self._versions)))
            future = self._client.submit(pickle.loads, call, pure=False)
            numbers[future] = index
            completed.add(future)

    def _read_outcome(self, future: Future) -> Outcome | None:
        if future.status == "cancelled":
            raise CancelledError
        error = future.exception()
        if isinstance(error, KilledWorker):
            return None
        outcome = f"cannot take part: {error}" if error else future.result()
        if isinstance(outcome, str):
            raise WorkerError(f"a worker {outcome}; install there what runs here")
        return outcome


def wait_for_some(completed: as_completed) -> list[Future]:
    """The futures that have ended, or none after WAIT_S; Ctrl-C ends it."""
    last, pause = clock.monotonic() + WAIT_S, SHORTEST_LOOK_S
    while not (batch := completed.next_batch(block=False)) and clock.monotonic() < last:
        look()
        clock.sleep(pause)
        pause = min(2.0 * pause, LONGEST_LOOK_S)
    return list(batch)
