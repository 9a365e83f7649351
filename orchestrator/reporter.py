"""Lines and progress bars of a command: bars on a terminal, plain lines elsewhere."""

import errno
import math
import os
import sys
import time as clock
from collections import defaultdict
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import AbstractContextManager, contextmanager, nullcontext
from contextvars import ContextVar
from pathlib import Path
from typing import Any, Protocol

from rich import box
from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn
from rich.segment import Segment
from rich.table import Table
from rich.text import Text

from models.core.interruption import answer, deferred, is_asked, look
from models.core.quantities import Vector
from models.core.remedies import Words, in_command_line, make_printable

from .compilation import announce_compilation
from .engine.effort import timed
from .engine.observer import Observer
from .engine.step import Step

# Stages of a run, by which `times` tells its parts apart; the time of compilations is among them.
COMPILING, COUPLED, REFERENCE, WITNESS = (
    "compiling",
    "coupled run, master",
    "monolithic reference",
    "multibody witness",
)
CHOICE, FMUS, RECORDS = "stability and errors of every method", "FMUs", "result file"
DRAWING, PAGE = "figures and report", "report"
COMPILES = "compiling what these components need (once on this machine; up to minutes)"
SHOWN_EVERY_S = 0.1
# Without a terminal a line says at least so often how far a long stage is.
TOLD_EVERY_S = 20.0
# From this share and time (s) on, what is done of a stage tells how long the rest takes.
LEAST_SHARE, LEAST_TIME_S = 0.1, 5.0


def estimate_left(share: float, seconds: float) -> str:
    """How long a task still takes of which a share was done in so many seconds; "" if that is not known."""
    if not LEAST_SHARE <= share < 1.0 or seconds < LEAST_TIME_S:
        return ""
    left = seconds * (1.0 / share - 1.0)
    return f", about {left:.0f} s left" if left < 100.0 else f", about {left / 60.0:.0f} min left"


class Show(Protocol):
    def __call__(self, share: float, words: str = "", /) -> None:
        """Show the share that is done, and words behind it."""


_innermost: ContextVar[Show | None] = ContextVar("innermost", default=None)
_stepping: ContextVar[bool] = ContextVar("stepping", default=False)


def show_share(share: float, words: str = "") -> None:
    """Show the share that is done of the stage around the caller, if there is one."""
    look()
    if show := _innermost.get():
        show(share, words)


class Bar(Observer):
    """An observer of a coupled run that calls `show` with the share that is done; the clock is read every 64
    steps."""

    def __init__(self, show: Show, stop_time: float) -> None:
        self.show, self._stop = show, stop_time
        self._count = 0
        self._shown = 0.0

    def observe(self, time: float, outputs: Callable[[], Vector], step: Step) -> None:
        look()
        self._count += 1
        if self._count % 64 == 0:
            now = clock.monotonic()
            if now - self._shown > SHOWN_EVERY_S:
                self.show(time / self._stop)
                self._shown = now

    def end(self, complete: bool, message: str) -> None:
        if complete:
            self.show(1.0)


# Errors of standard output. Where it has no buffer, flushing it does not meet them again.
unwritten: list[OSError] = []


class SafeConsole(Console):
    """Prints no more where the reader has left or the disk is full: results do not depend on what is shown.
    Names from files of others cannot command the terminal, and units in brackets are no styles.

    The error is kept for the command, which tells of it at its end.
    """

    def __init__(self, **options: Any) -> None:
        super().__init__(markup=False, emoji=False, **options)

    def on_broken_pipe(self) -> None:
        raise BrokenPipeError(errno.EPIPE, os.strerror(errno.EPIPE), "standard output")

    def _check_buffer(self) -> None:
        own = self._buffer
        own[:] = [one if one.control else Segment(make_printable(one.text), one.style) for one in own]
        try:
            super()._check_buffer()
        except OSError as error:
            unwritten.append(error)
            self._buffer.clear()
            self.quiet = True


@contextmanager
def look_between_steps() -> Iterator[None]:
    """In the block compilations look for no interruption: raised in a step it would be an FMU's error."""
    token = _stepping.set(True)
    try:
        yield
    finally:
        _stepping.reset(token)


def _look_outside_steps() -> None:
    if not _stepping.get():
        look()


@contextmanager
def tell_compilation() -> Iterator[None]:
    """Around a command: what is compiled outside its stages is told on standard error, again every 20 s."""
    begun = told = -math.inf

    def begin() -> None:
        nonlocal begun, told
        now = clock.monotonic()
        if _innermost.get() or now - told < TOLD_EVERY_S:
            return
        begun, since = (now, "") if begun < 0.0 else (begun, f", for {now - begun:.0f} s")
        SafeConsole(stderr=True, highlight=False).print(f"{COMPILES}{since}", soft_wrap=True)
        told = now

    with announce_compilation(begin, lambda seconds: None, _look_outside_steps):
        yield


@contextmanager
def tell_interruption(
    describe: Callable[[], str] = lambda: "only compiled code is kept: the same command begins anew",
) -> Iterator[None]:
    """Where Ctrl-C ends the block, KeyboardInterrupt says by `describe` what is kept and how to go on."""
    with deferred():
        try:
            yield
            look()
        except (Exception, KeyboardInterrupt) as error:
            interrupted = isinstance(error, KeyboardInterrupt)
            if not (interrupted or is_asked()):
                raise
            answer()
            text = str(error) if interrupted else ""
            raise KeyboardInterrupt(text or f"interrupted; {describe()}") from None


# Gets a stage in words and the share of it that is done, from 0 to 1.
Tell = Callable[[str, float], object]


class Reporter:
    """Prints the progress of a command, and gives it to `tell`; `verbose` also prints tables and effort.

    `times` has the wall time (s) of each stage without compilations, and that of these (`COMPILING`);
    `noticed` what was said of scenarios, which the page of a study repeats.
    """

    def __init__(
        self, console: Console | None = None, verbose: bool = False, tell: Tell = lambda words, share: None
    ) -> None:
        self.verbose, self._progress = verbose, tell
        # Lines for a file or a log need no folding to 80 columns.
        wide = None if sys.stdout.isatty() else 110
        self.console = console or SafeConsole(highlight=False, width=wide)
        self.times: dict[str, float] = defaultdict(float)
        self.noticed: dict[str, None] = {}
        self._told = 0.0

    def notice(self, texts: Iterable[str]) -> None:
        """Print what is to be known or doubted of a scenario."""
        for text in texts:
            self.line(text)
            self.noticed[text] = None

    def line(self, text: Words) -> None:
        self.console.print(Text(in_command_line(text)), soft_wrap=True)

    def keep_prints(self, path: Path) -> AbstractContextManager[None]:
        """For the block in which FMUs of others run: a command may put what they print into that file."""
        return nullcontext()

    @contextmanager
    def stage(
        self, text: str, stop_time: float = 1.0, estimate: Callable[[float, float], str] = estimate_left
    ) -> Iterator[Bar]:
        """A stage of the command with its bar; without a terminal lines, at its start and while it lasts.

        `estimate` puts the time left into words, by the share that is done and the seconds without
        compilations.
        """
        live, self._stage = self.console.is_terminal, text
        left = TextColumn("{task.fields[left]}")
        columns = TextColumn("{task.description}"), BarColumn(), TimeElapsedColumn(), left
        progress = Progress(*columns, console=self.console, transient=True, disable=not live)
        if not live:
            self.line(text)
        with progress, timed(self.times, text), announce_compilation(self._compiling, self._compiled):
            task = progress.add_task(text, total=1.0, left="")
            told = clock.monotonic()
            begun: tuple[float, float] | None = None  # the share that a part begins with, and when

            def show(share: float, words: str = "", /) -> None:
                nonlocal told, begun
                look()
                self._progress(f"{text}{words}", share)
                now = clock.monotonic()
                worked = now - self.times.get(COMPILING, 0.0)
                if begun is None or share < begun[0]:  # a run goes on, or a stage has another part
                    begun = share, worked
                    progress.reset(task)
                before, then = begun
                left = estimate((share - before) / (1.0 - before), worked - then) if share < 1.0 else ""
                progress.update(task, completed=share, description=f"{text}{words}", left=left)
                if not live and now - told > TOLD_EVERY_S and share < 1.0:
                    told = now
                    self.line(f"{text}: {100.0 * share:.0f} % done{words}{left}")

            look()
            self._progress(text, 0.0)
            around = _innermost.set(show)
            try:
                yield Bar(show, stop_time)
            finally:
                _innermost.reset(around)
            look()
            self._progress(text, 1.0)

    def _compiling(self) -> None:
        """Told once, and again while it lasts."""
        now = clock.monotonic()
        if COMPILING not in self.times:
            self.line(COMPILES)
            self._told = now
        elif now - self._told > TOLD_EVERY_S:
            self.line(f"{self._stage}: compiling, for {self.times[COMPILING]:.0f} s so far")
            self._told = now
        self._compiled(0.0)

    def _compiled(self, seconds: float) -> None:
        self.times[COMPILING] += seconds
        self.times[self._stage] -= seconds


def follow(show: Show, words: str = "", at: float | None = None) -> Reporter:
    """A reporter that prints nothing: `show` gets what its stages do, behind the `words`, with their share or
    `at` a share."""
    return Reporter(
        Console(quiet=True), tell=lambda stage, share: show(share if at is None else at, f"{words}, {stage}")
    )


def make_table(title: str, names: Sequence[str], numbers: Sequence[str], caption: str = "") -> Table:
    """A table with columns of names and, on their right, of numbers; rows are to be added."""
    table = Table(
        title=title, caption=caption or None, title_justify="left", caption_justify="left",
        box=box.SIMPLE_HEAD, pad_edge=False,
    )  # fmt: skip
    for head in names:
        table.add_column(head, overflow="fold")
    for head in numbers:
        table.add_column(head, justify="right", no_wrap=True)
    return table
