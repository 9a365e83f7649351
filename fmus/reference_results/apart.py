"""FMUs compared in a process of their own, so that one that crashes is an answer and not the end."""

from collections.abc import Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from multiprocessing import get_context
from pathlib import Path

from .compare import Comparison, compare
from .files import ComparisonError


def compare_in_process(
    paths: Sequence[Path], tolerance: float | None
) -> Iterator[tuple[Path, Comparison | ComparisonError]]:
    """What `compare` says of each file, or why nothing can be said; one process until a file ends it."""
    pool = _pool()
    try:
        for path in paths:
            try:
                yield path, pool.submit(compare, path, tolerance).result()
            except ComparisonError as error:
                yield path, error
            except BrokenProcessPool:
                pool.shutdown()
                pool = _pool()
                yield path, ComparisonError(f"{path}: the FMU crashed: it ended the process that ran it")
    finally:
        pool.shutdown(cancel_futures=True)


def _pool() -> ProcessPoolExecutor:
    """One worker, a fresh interpreter: a copy of this process would have its threads' locks."""
    return ProcessPoolExecutor(1, get_context("spawn"))
