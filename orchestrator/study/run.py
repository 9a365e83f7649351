"""Evaluates and stores the pending points of a study."""

import time as clock
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from models.core.system import ModelError
from models.core.words import tally

from ..errors import MistakeError, Option
from ..reporter import Bar, Reporter, tell_interruption
from ..store.output_folder import refuse_file
from .cluster import connect
from .execution import Execution
from .files import Plan
from .points import POINT
from .source import compute_fingerprint
from .store import DONE, FAILED, PENDING, Store, open_store

COMPLETE, SOME_FAILED = 0, 1
# Results are written so often (s), and for at most this share of the time: a file for each takes its time.
WRITE_S, WRITING = 1.0, 0.02


@dataclass(frozen=True)
class Where:
    """Where points are evaluated: at `scheduler`, or on `workers` processes here (default: all cores)."""

    scheduler: str | None = None
    workers: int | None = None
    timeout: float = 10.0

    def __post_init__(self) -> None:
        if self.workers is not None and self.workers < 1:
            raise MistakeError((Option("workers", self.workers), ": must be 1 or more"))


def run(
    plan: Plan,
    out: Path,
    where: Where,
    reporter: Reporter,
    overwrite: bool = False,
    retry_failed: bool = False,
) -> int:
    """Evaluate the pending points of the store at `out`; return the command's exit status.

    Raises MistakeError before anything is written, RunError if the workers cannot go on, and
    KeyboardInterrupt with how to continue. The last two keep all finished points.
    """
    refuse_file(out)
    reporter.notice(_list_warnings(plan))
    versions = compute_fingerprint(plan.subject)
    with (
        connect(where.scheduler, where.workers, where.timeout) as client,
        open_store(out, plan, versions, overwrite) as store,
    ):
        if retry_failed:
            store.retry_failed()
        if not client.nthreads():
            at = where.scheduler
            reporter.line(f"no workers at {at} yet; start some with: dask worker {at}")
        execution = Execution(client, plan.subject, plan.points, versions)

        def describe() -> str:
            store.flush()  # the last one may have been interrupted
            left = store.count(PENDING)
            done = f"{tally(len(plan.points) - left, 'point')} kept in {out}, {left} left"
            none = f"no point is finished, only compiled code is kept, {left} left"
            return f"{done if left < len(plan.points) else none}: the same command continues"

        with tell_interruption(describe):
            with reporter.stage(plan.study.name) as bar:
                _evaluate(execution, store, bar)
            return _report_end(plan, store, out, reporter)


def _list_warnings(plan: Plan) -> list[str]:
    """Warnings about the first and the last point; a point with a mistake fails later, with its message."""
    found: dict[str, None] = {}
    for index in (0, len(plan.points) - 1):
        with suppress(MistakeError, ModelError):
            found |= dict.fromkeys(plan.subject.list_warnings(plan.points[index]))
    return list(found)


def _evaluate(execution: Execution, store: Store, bar: Bar) -> None:
    def show() -> None:
        failed = store.count(FAILED)
        bar.show((store.count(DONE) + failed) / store.status.size, f", {failed} failed" if failed else "")

    show()
    try:
        next_write = clock.monotonic() + WRITE_S
        for batch in execution.outcomes(store.pending()):
            for index, outcome in batch:
                store.record(index, outcome)
            if (begun := clock.monotonic()) > next_write:
                store.flush()
                now = clock.monotonic()
                next_write = now + max(WRITE_S, (now - begun) / WRITING)
            show()
    finally:
        store.flush()


def _publish(plan: Plan, out: Path) -> list[Path]:
    """The table beside the store, and a figure of a grid with one or two axes."""
    import xarray

    from ..plots.style import save_figure
    from .figure import draw_figure
    from .table import write_table

    stem = out.name.removesuffix(".zarr")
    files = [out.with_name(f"{stem}.csv")]
    names = plan.study.figure or plan.subject.default_figure
    # Without chunks: by this process, as the scheduler may have ended.
    with xarray.open_zarr(out, chunks=None) as found:
        write_table(found, files[0])
        if POINT not in plan.points.dimensions and len(plan.points.dimensions) <= 2 and names:
            files.append(save_figure(lambda: draw_figure(found, names), out.with_name(f"{stem}.png")))
    return files


def _report_end(plan: Plan, store: Store, out: Path, reporter: Reporter) -> int:
    reporter.line(f"results in {out}, {', '.join(str(path) for path in _publish(plan, out))}")
    failed = np.flatnonzero(store.status == FAILED)
    line = f"{out}: {tally(store.count(DONE), 'point')} done, {len(failed)} failed"
    if not len(failed):
        reporter.line(line)
        return COMPLETE
    first = int(failed[0])
    values = ", ".join(f"{name} = {value}" for name, value in plan.points[first].items())
    reporter.line(f"{line}, the first at {values}: {store.message(first)}")
    return SOME_FAILED
