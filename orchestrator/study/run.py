"""Evaluates and stores the pending points of a study."""

from __future__ import annotations

import time as clock
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from rich.progress import (
    BarColumn,
    MofNCompleteColumn,
    Progress,
    TextColumn,
    TimeElapsedColumn,
    TimeRemainingColumn,
)

from models.core.system import ModelError

from ..errors import MistakeError
from ..reporter import TOLD_EVERY_S, Reporter, estimate_left
from .cluster import connect
from .execution import Execution
from .files import Plan
from .points import POINT
from .source import compute_fingerprint
from .store import DONE, FAILED, PENDING, Store, open_store


class StudyProgress:
    """Shows the points done, failed and left, those of earlier starts included."""

    def __init__(self, reporter: Reporter, name: str, total: int) -> None:
        self._reporter = reporter
        self._name, self._total = name, total
        self._live = reporter.console.is_terminal
        columns = (
            TextColumn("{task.description}"),
            BarColumn(),
            MofNCompleteColumn(),
            TextColumn("{task.fields[failed]} failed"),
            TimeElapsedColumn(),
            TimeRemainingColumn(),
        )
        self._bar = Progress(*columns, console=reporter.console, transient=True, disable=not self._live)
        self._task = self._bar.add_task(name, total=total, failed=0)
        self._tenth = -1
        self._begun: tuple[int, float] | None = None  # points that were there, and when
        self._told = 0.0

    def __enter__(self) -> StudyProgress:
        self._bar.start()
        return self

    def __exit__(self, *ignored: object) -> None:
        self._bar.stop()

    def show(self, done: int, failed: int) -> None:
        finished = done + failed
        self._bar.update(self._task, completed=finished, failed=failed)
        tenth, now = 10 * finished // self._total, clock.monotonic()
        self._begun = self._begun or (finished, now)
        if not self._live and (tenth > self._tenth or now - self._told > TOLD_EVERY_S):
            self._tenth, self._told = tenth, now
            left = self._total - finished
            text = f"{self._name}: {done} done, {failed} failed, {left} to do{self._estimate(finished, left)}"
            self._reporter.tell(text, finished / self._total)

    def _estimate(self, finished: int, left: int) -> str:
        """How long the points that are left take, if that is known."""
        before, begun = self._begun or (0, 0.0)
        share = (finished - before) / (finished - before + left) if left else 1.0
        return estimate_left(share, clock.monotonic() - begun)


COMPLETE, SOME_FAILED = 0, 1
# Results are written so often (s): a file for each of them takes a tenth of a second together.
WRITE_S = 1.0


@dataclass(frozen=True)
class Where:
    """Where points are evaluated: at `scheduler`, or on `workers` processes here (default: all cores)."""

    scheduler: str | None = None
    workers: int | None = None
    timeout: float = 10.0


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
    for line in _list_warnings(plan):
        reporter.line(line)
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
        try:
            with StudyProgress(reporter, plan.study.name, len(plan.points)) as progress:
                _evaluate(execution, store, progress)
        except KeyboardInterrupt:
            store.flush()  # the last one may have been interrupted
            left = store.count(PENDING)
            raise KeyboardInterrupt(
                f"interrupted; {len(plan.points) - left} points are kept in {out}, {left} are left: "
                "the same command continues"
            ) from None
        return _report_end(plan, store, out, reporter)


def _list_warnings(plan: Plan) -> list[str]:
    """Warnings about the first and the last point; a point with a mistake fails later, with its message."""
    found: dict[str, None] = {}
    for index in (0, len(plan.points) - 1):
        with suppress(MistakeError, ModelError):
            found |= dict.fromkeys(plan.subject.list_warnings(plan.points[index]))
    return list(found)


def _evaluate(execution: Execution, store: Store, progress: StudyProgress) -> None:
    progress.show(store.count(DONE), store.count(FAILED))
    try:
        written = clock.monotonic()
        for batch in execution.outcomes(store.pending()):
            for index, outcome in batch:
                store.record(index, outcome)
            if clock.monotonic() > written + WRITE_S:
                store.flush()
                written = clock.monotonic()
            progress.show(store.count(DONE), store.count(FAILED))
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
    line = f"{out}: {store.count(DONE)} points done, {len(failed)} failed"
    if not len(failed):
        reporter.line(line)
        return COMPLETE
    first = int(failed[0])
    values = ", ".join(f"{name} = {value}" for name, value in plan.points[first].items())
    reporter.line(f"{line}, the first at {values}: {store.message(first)}")
    return SOME_FAILED
