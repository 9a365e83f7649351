"""Points to workers and outcomes back, as they come."""

from __future__ import annotations

import pickle
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import CancelledError
from contextlib import suppress
from dataclasses import dataclass
from itertools import islice
from typing import Any

from distributed import Client, Future, as_completed
from distributed.scheduler import KilledWorker

from ..errors import RunError
from .points import Points
from .subjects import Subject
from .task import Outcome, evaluate

# Points given out for each thread: none waits while outcomes are written, and a scheduler holds few.
AHEAD = 4

DIED = "the worker's process died at this point, more than once (out of memory, or a crash in compiled code)"


class WorkerError(RunError):
    """A worker that cannot take part, or a scheduler that is gone."""


@dataclass(frozen=True)
class Call:
    """Unpickles as what `function` returns.

    A worker that lacks our packages would end if it were sent one of our functions; unpickling is a task that
    any worker can begin, and what is missing comes back as its error.
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
        """The outcomes of these points in the order in which they come, all that are there at a time.

        A point on a worker that dies goes to another. One that was on several that died may have been
        among others, so it is evaluated again alone, and only then is it recorded as what kills them.
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
        """Outcomes; None where workers died."""
        waiting = iter(indices)
        numbers: dict[Future, int] = {}
        completed = as_completed()
        try:
            self._submit(islice(waiting, self._count_slots(ahead)), numbers, completed)
            for batch in completed.batches():
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
