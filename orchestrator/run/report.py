"""What a run says while it goes on and at its end: on a terminal with a bar, elsewhere in plain lines."""

from __future__ import annotations

import errno
import os
import sys
import time as clock
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from rich import box
from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeRemainingColumn
from rich.table import Table
from rich.text import Text

from models.core.quantities import Vector

from ..assessment.comparison import Errors, VariableError
from ..assessment.contacts import lines as contact_lines
from ..assessment.diagnosis import brief
from ..assessment.summary import Summary
from ..energy.account import lines as energy_lines
from ..engine.step import Step
from ..store.run_state import shown
from .compilation import COMPILING, noticed

SHOWN_EVERY_S = 0.1


class Bar:
    """An observer and a callback that show how far a run has come; the clock is read every 64 steps."""

    def __init__(self, progress: Progress, task: Any, stop_time: float) -> None:
        self._progress, self._task, self._stop = progress, task, stop_time
        self._count = 0
        self._shown = 0.0

    def begin(self, names: Sequence[str]) -> None:
        pass

    def observe(self, time: float, outputs: Callable[[], Vector], step: Step) -> None:
        self._count += 1
        if self._count % 64 == 0:
            now = clock.monotonic()
            if now - self._shown > SHOWN_EVERY_S:
                self.show(time / self._stop)
                self._shown = now

    def end(self, complete: bool, message: str) -> None:
        if complete:
            self.show(1.0)

    def show(self, fraction: float) -> None:
        self._progress.update(self._task, completed=fraction)


class _Console(Console):
    """Where the reader has left, rich's ends the program with the status of a run outside its tolerance."""

    def on_broken_pipe(self) -> None:
        raise BrokenPipeError(errno.EPIPE, os.strerror(errno.EPIPE), "standard output")


class Reporter:
    """Says what happens."""

    def __init__(self, console: Console | None = None) -> None:
        # Lines for a file or a log need no folding to 80 columns.
        wide = None if sys.stdout.isatty() else 110
        self.console = console or _Console(highlight=False, width=wide)
        self._compiled = False

    def line(self, text: str) -> None:
        self.console.print(Text(text), soft_wrap=True)

    @contextmanager
    def stage(self, text: str, stop_time: float = 1.0) -> Iterator[Bar]:
        """A stage of the run with its bar; without a terminal, a line when it begins."""
        live = self.console.is_terminal
        columns = (TextColumn("{task.description}"), BarColumn(), TimeRemainingColumn())
        progress = Progress(*columns, console=self.console, transient=True, disable=not live)
        if not live:
            self.line(text)
        with progress, noticed(COMPILING, self._compiling):
            yield Bar(progress, progress.add_task(text, total=1.0), stop_time)

    def _compiling(self) -> None:
        if not self._compiled:
            self.line("compiling what these components need (once on this machine; up to minutes)")
        self._compiled = True

    def end(self, summary: Summary, out: Path, files: Sequence[Path]) -> None:
        """What the run came to: the engineering result, the verdict with its table, effort and files."""
        for line in contact_lines(summary.contacts, summary.contacts_from, summary.fixed_steps):
            self.line(line)
        for line in energy_lines(summary.energy) if summary.energy else ():
            self.line(line)
        if summary.steps:
            for line in brief(summary.steps, summary.suggestions):
                self.line(line)
        for name, given in summary.warnings.items():
            first = f", the first: {given.first}" if given.first else "; it does not say of what"
            self.line(f"{name}: the FMU gave {given.count} warning{'s' * (given.count > 1)}{first}")
        for name, since in summary.not_numbers.items():
            self.line(
                f"{name}: not a number (NaN) from t = {since:.6g} s on, or at times; look at its participant"
            )
        if summary.python_sweeps:
            reasons = ", ".join(f"{name} ({why})" for name, why in summary.python_sweeps.items())
            self.line(f"macro steps in Python, not in compiled code, for {reasons}")
        if summary.complete:
            self.line(f"{summary.scenario}: {summary.verdict}")
        if summary.errors:
            self._compare(summary.errors)
        self._effort(summary)
        self.line(f"results in {shown(out)}: {', '.join(str(file.relative_to(out)) for file in files)}")

    def _effort(self, summary: Summary) -> None:
        if summary.coupled_time_s:
            speed = summary.macro_steps / summary.coupled_time_s
            reference = summary.reference_time_s
            self.line(
                f"{summary.macro_steps} macro steps, {summary.iterations} iterations in "
                f"{summary.coupled_time_s:.2f} s ({speed:.0f} steps/s)"
                + ("" if reference is None else f"; reference {reference:.2f} s")
                + f"; all {summary.wall_time_s:.1f} s"
            )

    def _compare(self, errors: Errors) -> None:
        """The comparison as a table; variables with a tolerance first."""
        starred = any(error.below_uncertainty for error in errors.values())
        table = Table(
            title="Coupled run against the monolithic reference (SI units)",
            caption="* below the reference's own uncertainty" if starred else None,
            title_justify="left",
            caption_justify="left",
            box=box.SIMPLE_HEAD,
            pad_edge=False,
        )
        table.add_column("variable", overflow="fold")
        for column in ("max", "RMS", "relative\nRMS", "reference\n±", "allowed"):
            table.add_column(column, justify="right", no_wrap=True)
        table.add_column("")
        for name, error in sorted(errors.items(), key=lambda item: item[1].tolerance is None):
            mark = "*" if error.below_uncertainty else ""
            table.add_row(
                Text(name),
                f"{error.max_abs:.1e}",
                f"{error.rms:.1e}",
                f"{error.relative_rms:.1e}{mark}",
                f"{error.uncertainty.relative_rms:.0e}",
                "" if error.tolerance is None else f"{error.tolerance:.0e}",
                _mark(error),
            )
        self.console.print(table)


def _mark(error: VariableError) -> Text:
    if error.tolerance is None:
        return Text("")
    return Text("within", "green") if error.within else Text("OUTSIDE", "bold red")
