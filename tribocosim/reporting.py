"""What a run from Python tells while it computes."""

import io

from rich.console import Console

from orchestrator.reporter import Reporter, Tell

# Gets the stage in words and the share of it that is done, from 0 to 1.
Progress = Tell


class SilentReporter(Reporter):
    """Prints nothing; `progress` is told how far each stage is."""

    def __init__(self, progress: Progress | None = None) -> None:
        console = Console(file=io.StringIO(), force_jupyter=False)  # a notebook shows it otherwise
        super().__init__(console, tell=progress or (lambda words, share: None))
