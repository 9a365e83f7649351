"""What a run came to, from its first line in summary.json to the last."""

import json
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field, replace
from importlib import metadata
from pathlib import Path
from typing import Any

from models.contact.records import ATOM
from models.core.interruption import answer

from ..assessment.contacts import ContactSummaries, list_details, name_estimates
from ..assessment.contacts import lines as contact_lines
from ..assessment.diagnosis import Diagnosis, brief
from ..assessment.merits import Friction, Merit
from ..engine.effort import Spent
from ..engine.energy.account import Account
from ..engine.energy.account import lines as energy_lines
from ..errors import (
    CheckpointError,
    DiscardedStepError,
    ExplainedError,
    RefusedError,
    RunError,
    Words,
    in_command_line,
    join,
)
from ..scenario.capabilities import MONOLITHIC
from ..store import atomic_write
from ..texts import to_plain
from .comparison import Errors, WitnessComparison
from .plan import Plan

# Exit statuses of the command line.
WITHIN, OUTSIDE, FAILED, NOT_COMPARED, INTERRUPTED = 0, 1, 3, 4, 130
# The errors that end a run early and leave a result; all others are faults of the program.
ENDS = (KeyboardInterrupt, OSError, RunError, ValueError, ArithmeticError)
# Macro steps of a run that was ended: fewer say nothing of the motion.
FEW = 500
# Where extremes of contacts are from.
MACRO_STEPS, ROWS = "all macro steps", "recorded rows"


@dataclass(frozen=True)
class Warnings:
    """The number of warnings of an FMU, and the first message (may be empty)."""

    count: int
    first: str


@dataclass(frozen=True)
class Summary:
    """What a run came to: first that it has not ended; then what it did, how it ended, and its assessment."""

    scenario: str
    description: str
    version: str
    master: dict[str, Any]
    macro_step: float
    fixed_steps: bool
    tolerance: dict[str, float]
    figures: bool = True  # were to be drawn; `tribocosim resume` does the same
    complete: bool = False
    resumable: bool = True  # `tribocosim resume` can continue it
    message: Words = "the run was not finished"
    verdict: Words = "not compared"
    largest_error: str = ""
    exit_status: int = FAILED
    macro_steps: int = 0
    rejected_steps: int = 0
    iterations: int = 0
    do_steps: int | None = None  # of single participants; None where the run did not end
    wall_time_s: float = 0.0
    coupled_time_s: float = 0.0
    reference_time_s: float | None = None
    reference_uncertainty: float | None = None
    reference_method: str = MONOLITHIC
    witness: WitnessComparison | None = None
    errors: Errors = field(default_factory=dict)
    contacts: ContactSummaries = field(default_factory=dict)
    contacts_from: str = MACRO_STEPS
    merits: Sequence[str] = field(default_factory=list)
    friction: Friction | None = None
    figures_of_merit: Sequence[Merit] = ()  # in a table of their own
    times: Mapping[str, float] = field(default_factory=dict)  # wall time (s) by stage
    effort: Mapping[str, Spent] = field(default_factory=dict)
    energy: Account | None = None
    steps: Diagnosis | None = None
    suggestions: Sequence[str] = field(default_factory=list)
    warnings: Mapping[str, Warnings] = field(default_factory=dict)
    senseless: Mapping[str, float] = field(default_factory=dict)  # the first time (s) an output was so
    frozen: Sequence[str] = ()  # FMUs that stand still
    python_sweeps: Mapping[str, str] = field(default_factory=dict)  # slow participants: reason
    without_rates: Sequence[str] = ()  # participants whose rates were not used
    unproven: Sequence[str] = ()  # what participants say of themselves and does not hold
    discarding: str = ""  # the participant that ended the run by discarding a step
    fmus: dict[str, str] = field(default_factory=dict)
    notices: Sequence[Words] = field(default_factory=list)

    @property
    def whole(self) -> bool:
        """Whether the coupled run came to its end, though it may lack the comparison with its reference."""
        return self.do_steps is not None

    def end_by(self, error: BaseException, out: Path) -> "Summary":
        """As ended by one of `ENDS`. Raises `error` again if it leaves no result."""
        if isinstance(error, (CheckpointError, RefusedError)):
            raise error
        if isinstance(error, KeyboardInterrupt):
            answer()
            return replace(self, complete=False, message="incomplete: interrupted", exit_status=INTERRUPTED)
        said = error if isinstance(error, ExplainedError) else str(error)
        if lasting := not isinstance(error, OSError):  # it would fail again
            message = join("incomplete: ", said)
        else:
            message = f"incomplete: {error.filename or out}: {error.strerror or error}"
        resumable = self.resumable and not lasting
        discarding = error.participant if isinstance(error, DiscardedStepError) else ""
        ended = replace(self, complete=False, resumable=resumable, message=message, exit_status=FAILED)
        return replace(ended, discarding=discarding)

    def tell(self) -> list[Words]:
        """What trains, contacts, energies and steps came to, and warnings of FMUs, in words."""
        return self._tell(name_estimates(self.contacts))

    def _tell(self, films: Sequence[str]) -> list[Words]:
        """The same with these lines of films."""
        lines: list[Words] = []
        if self.complete or self.macro_steps >= FEW:
            lines += self.merits
            lines += [*contact_lines(self.contacts, self.fixed_steps), *films]
            lines += energy_lines(self.energy) if self.energy else []
            lines += brief(self.steps, self.suggestions) if self.steps else []
        for name, given in self.warnings.items():
            first = f", the first: {given.first}" if given.first else "; it does not say of what"
            lines.append(f"{name}: the FMU gave {given.count} warning{'s' * (given.count > 1)}{first}")
        for name, one in self.effort.items():
            if one.failed:
                lines.append(f"{name}: discarded {one.failed} of the {one.own_steps} steps that it tried")
        lines += self.unproven
        if self.without_rates:
            lines.append(
                f"{', '.join(self.without_rates)}: rates of change are no numbers at the start, so signals "
                "go through values only"
            )
        lines += self.frozen
        for name, since in self.senseless.items():
            lines.append(
                f"{name}: not finite, or above 1e30 times its nominal size, from t = {since:.6g} s on, or at "
                "times; look at its participant, whose own solver may need a shorter macro_step"
            )
        return lines

    def content(self) -> dict[str, Any]:
        """As plain JSON values."""
        message, verdict = map(in_command_line, (self.message, self.verdict))
        details = self._tell(list_details(self.contacts, self.contacts_from))
        content = asdict(replace(self, message=message, verdict=verdict, figures_of_merit=()))
        del content["figures_of_merit"]
        for contact in content["contacts"].values():
            contact["film"] = contact["film"] if contact["film"] >= ATOM else 0.0
        content["notices"] = list(map(in_command_line, [*self.notices, *details]))
        for name, error in self.errors.items():
            own = content["errors"][name].pop("uncertainty")
            content["errors"][name] |= {
                "reference_uncertainty": own["relative_rms"],
                "below_reference_uncertainty": error.below_uncertainty,
                "within_tolerance": error.within if error.tolerance is not None else None,
            }
        found: dict[str, Any] = to_plain(content)
        return found

    def write(self, path: Path) -> None:
        text = json.dumps(self.content(), indent=2, allow_nan=False)
        atomic_write.write_whole(path, f"{text}\n".encode())


def begin_summary(plan: Plan) -> Summary:
    """Of a run that has not ended."""
    scenario = plan.scenario
    return Summary(
        scenario=scenario.name,
        description=scenario.description,
        version=metadata.version("tribocosim"),
        master=scenario.master.model_dump(),
        macro_step=scenario.macro_step,
        fixed_steps=scenario.step_control is None,
        tolerance=dict(plan.tolerance),
        figures=plan.figures,
        fmus=plan.sha256,
        notices=plan.notices,
    )
