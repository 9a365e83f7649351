"""Progress of a study: a bar on a terminal, elsewhere a line for each tenth and at least each 20 s."""

from __future__ import annotations

import time as clock

from rich.progress import (
    BarColumn,
    MofNCompleteColumn,
    Progress,
    TextColumn,
    TimeElapsedColumn,
    TimeRemainingColumn,
)

from ..reporter import TOLD_EVERY_S, Reporter, estimate_left


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
