"""What is to be run, and where."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from models.core.system import System

from ..scenario import Scenario
from ..store.json_codec import Plain
from . import assembly
from .checkpoint import Identity
from .report import Reporter


@dataclass(frozen=True)
class Job:
    """A run to be carried out. `folder` is that of what is unfinished in `out`.

    `resumed` is a checkpoint, `spent` the wall time (s) of the processes before this one. `begun` is called
    when the first values are there to be recorded; `spared` says whether `out` has a result of before that is
    kept, since there were none.
    """

    scenario: Scenario
    system: System
    out: Path
    folder: Path
    build: assembly.Builder
    reporter: Reporter
    figures: bool
    resumed: tuple[Identity, Plain] | None = None
    spent: float = 0.0
    begun: Callable[[], None] = lambda: None
    spared: Callable[[], bool] = lambda: False
