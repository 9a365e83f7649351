"""What a run came to: summary.json."""

from __future__ import annotations

import json
import math
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

from ..energy.account import Account
from ..store.atomic_write import replace
from .comparison import Errors
from .contacts import Courses
from .diagnosis import Diagnosis

# Exit statuses of the command line.
WITHIN, OUTSIDE, MISTAKE, FAILED, NOT_COMPARED, INTERRUPTED = 0, 1, 2, 3, 4, 130


# Where extremes of contacts are from.
MACRO_STEPS, ROWS = "all macro steps", "recorded rows"


@dataclass(frozen=True)
class Warnings:
    """How many an FMU gave, and the first message, empty if it says none."""

    count: int
    first: str


@dataclass
class Summary:
    """Filled in while the run goes on, so that an incomplete one has what is known."""

    scenario: str
    description: str
    version: str
    master: dict[str, Any]
    macro_step: float
    fixed_steps: bool
    tolerance: dict[str, float]
    figures: bool = True  # were to be drawn; `tribocosim resume` keeps to it
    complete: bool = False
    resumable: bool = True  # `tribocosim resume` can go on
    message: str = "the run was not finished"
    verdict: str = "not compared"
    exit_status: int = FAILED
    macro_steps: int = 0
    rejected_steps: int = 0
    iterations: int = 0
    do_steps: int | None = None  # of single participants; None where the run did not end
    wall_time_s: float = 0.0
    coupled_time_s: float = 0.0
    reference_time_s: float | None = None
    reference_uncertainty: float | None = None
    errors: Errors = field(default_factory=dict)
    contacts: Courses = field(default_factory=dict)
    contacts_from: str = MACRO_STEPS
    energy: Account | None = None
    steps: Diagnosis | None = None
    suggestions: list[str] = field(default_factory=list)
    warnings: dict[str, Warnings] = field(default_factory=dict)
    not_numbers: dict[str, float] = field(default_factory=dict)  # since when (s) an output was NaN
    python_sweeps: dict[str, str] = field(default_factory=dict)  # which participants cost the fast path, why
    fmus: dict[str, str] = field(default_factory=dict)

    def content(self) -> dict[str, Any]:
        """As plain JSON values."""
        content = asdict(self)
        for name, error in self.errors.items():
            own = content["errors"][name].pop("uncertainty")
            content["errors"][name] |= {
                "reference_uncertainty": own["relative_rms"],
                "below_reference_uncertainty": error.below_uncertainty,
                "within_tolerance": error.within if error.tolerance is not None else None,
            }
        return _strict(content)

    def write(self, path: Path) -> None:
        replace(path, (json.dumps(self.content(), indent=2, allow_nan=False) + "\n").encode())


def _strict(value: Any) -> Any:
    """JSON has no infinity and no NaN: null instead."""
    if isinstance(value, dict):
        return {str(key): _strict(item) for key, item in value.items()}
    if isinstance(value, (list, tuple)):
        return [_strict(item) for item in value]
    if isinstance(value, (bool, int, str, type(None))):
        return value
    number = float(value)
    return number if math.isfinite(number) else None
