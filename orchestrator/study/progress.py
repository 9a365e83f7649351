"""Progress of a study: a bar on a terminal, elsewhere a line for each tenth."""

from __future__ import annotations

from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

from ..reporter import Reporter


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
            TimeRemainingColumn(),
        )
        self._bar = Progress(*columns, console=reporter.console, transient=True, disable=not self._live)
        self._task = self._bar.add_task(name, total=total, failed=0)
        self._tenth = -1

    def __enter__(self) -> StudyProgress:
        self._bar.start()
        return self

    def __exit__(self, *ignored: object) -> None:
        self._bar.stop()

    def show(self, done: int, failed: int) -> None:
        finished = done + failed
        self._bar.update(self._task, completed=finished, failed=failed)
        tenth = 10 * finished // self._total
        if not self._live and tenth > self._tenth:
            self._tenth = tenth
            left = self._total - finished
            self._reporter.line(f"{self._name}: {done} done, {failed} failed, {left} left")
