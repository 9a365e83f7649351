"""What a coupled run did, and how it ended."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from models.core.remedies import ExplainedError, Words, join

from ..assessment.contacts import ContactSummaries
from ..engine.energy.account import Account
from ..errors import CheckpointError, RefusedError, RunError

# Exit statuses of the command line.
WITHIN, OUTSIDE, MISTAKE, FAILED, NOT_COMPARED, INTERRUPTED = 0, 1, 2, 3, 4, 130

# The errors that end a run early and leave a result; all others are faults of the program.
ENDS = (KeyboardInterrupt, OSError, RunError, ValueError, ArithmeticError)


@dataclass(frozen=True)
class Ending:
    """How a run ended. By default it has not."""

    complete: bool = False
    resumable: bool = True  # `tribocosim resume` can continue it
    message: Words = "the run was not finished"
    exit_status: int = FAILED


def classify_ending(error: BaseException, out: Path) -> Ending:
    """The ending that one of `ENDS` means. Raises `error` again if it leaves no result."""
    if isinstance(error, (CheckpointError, RefusedError)):
        raise error
    if isinstance(error, KeyboardInterrupt):
        return Ending(message="incomplete: interrupted", exit_status=INTERRUPTED)
    if isinstance(error, OSError):
        return Ending(message=f"incomplete: {error.filename or out}: {error.strerror or error}")
    shown = error if isinstance(error, ExplainedError) else str(error)
    return Ending(resumable=False, message=join("incomplete: ", shown))  # it would fail again


@dataclass(frozen=True)
class Warnings:
    """The number of warnings of an FMU, and the first message (may be empty)."""

    count: int
    first: str


@dataclass(frozen=True)
class Record:
    """What the coupled run did, to its end or to where it was stopped. Its rows are in the journals."""

    ending: Ending = Ending()
    macro_steps: int = 0
    iterations: int = 0
    do_steps: int | None = None  # of single participants; None where the run did not end
    coupled_time_s: float = 0.0
    contacts: ContactSummaries = field(default_factory=dict)
    energy: Account | None = None
    warnings: Mapping[str, Warnings] = field(default_factory=dict)
    not_finite: Mapping[str, float] = field(default_factory=dict)  # the first time (s) an output was so
    python_sweeps: Mapping[str, str] = field(default_factory=dict)  # slow participants: reason
    without_rates: Sequence[str] = ()  # participants whose rates were not used
    unproven: Sequence[str] = ()  # why participants were not restored
