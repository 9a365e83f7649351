"""What a run from Python tells while it computes."""

import io
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from rich.console import Console

from orchestrator.reporter import Bar, Reporter

# Gets the stage in words and the share of it that is done, from 0 to 1.
Progress = Callable[[str, float], object]


class SilentReporter(Reporter):
    """Prints nothing; `progress` is told how far each stage is."""

    def __init__(self, progress: Progress | None = None) -> None:
        super().__init__(Console(file=io.StringIO(), force_jupyter=False))  # a notebook shows it otherwise
        self._progress = progress

    @contextmanager
    def stage(self, text: str, stop_time: float = 1.0) -> Iterator[Bar]:
        tell = self._progress
        with super().stage(text, stop_time) as bar:
            if tell is None:
                yield bar
                return

            def show(share: float, words: str = "", /) -> None:
                tell(f"{text}{words}", share)

            show(0.0)
            yield Bar(show, stop_time)
            show(1.0)
