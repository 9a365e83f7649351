"""The same function at many points, on all cores."""

import os
import threading
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor, wait
from typing import TypeVar

Point = TypeVar("Point")
Value = TypeVar("Value")

# Points that a thread takes at a time: at most so many, and few enough that each thread comes back so often.
LARGEST_CHUNK, CHUNKS = 16, 8
# Seconds between two looks at what is done; an interruption is answered as fast.
LOOK = 0.2


def cores() -> int:
    """The cores that this process may use.

    No more than OMP_NUM_THREADS, which schedulers set to 1 for each of many processes on one machine.
    """
    here = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    most = os.environ.get("OMP_NUM_THREADS", "")
    return min(here, max(1, int(most))) if most.isdecimal() else here


def no_progress(done: int, total: int) -> None:
    """Tells nobody."""


def each(
    function: Callable[[Point], Value],
    points: Sequence[Point],
    workers: int | None = None,
    progress: Callable[[int, int], None] = no_progress,
) -> list[Value]:
    """[function(point) for point in points], by threads (None: one a core).

    Threads gain where `function` spends its time in kernels, which release the interpreter. The result does
    not depend on their number. `progress(done, total)` is called by the calling thread. What `function`
    raises, or an interruption, ends all threads after the point that they are at.
    """
    stop = threading.Event()

    def run(part: Sequence[Point]) -> list[Value]:
        return [function(point) for point in part if not stop.is_set()]

    # The first point alone: kernels are compiled, or loaded, once.
    values = [function(point) for point in points[:1]]
    threads = workers or cores()
    size = min(LARGEST_CHUNK, max(1, len(points) // (CHUNKS * threads)))
    parts = [points[first : first + size] for first in range(1, len(points), size)]
    with ThreadPoolExecutor(threads) as pool:
        futures = [pool.submit(run, part) for part in parts]
        waiting = set(futures)
        try:
            while waiting:
                done, waiting = wait(waiting, LOOK)
                for future in done:
                    future.result()
                left = sum(len(parts[i]) for i, future in enumerate(futures) if not future.done())
                progress(len(points) - left, len(points))
        finally:
            stop.set()
            pool.shutdown(cancel_futures=True)
    for future in futures:
        values += future.result()
    return values
