"""What a run is worth: its contacts, steps and errors, and their summary in summary.json."""

import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field, replace
from importlib import metadata
from pathlib import Path
from typing import Any

from models.contact.records import ATOM

from ..assessment.contacts import ContactSummaries
from ..assessment.contacts import lines as contact_lines
from ..assessment.diagnosis import Diagnosis, brief
from ..assessment.merits import Merit
from ..engine.energy.account import Account
from ..engine.energy.account import lines as energy_lines
from ..errors import Words, in_command_line
from ..store import atomic_write
from .comparison import Errors, WitnessComparison, describe_largest
from .plan import MONOLITHIC, Plan
from .record import FAILED, Ending, Record, Warnings

# Where extremes of contacts are from.
MACRO_STEPS, ROWS = "all macro steps", "recorded rows"


@dataclass(frozen=True)
class Assessment:
    """The assessment of a run, complete or not."""

    ending: Ending
    contacts: ContactSummaries
    contacts_from: str = MACRO_STEPS
    merits: Sequence[str] = field(default_factory=list)
    figures_of_merit: Sequence[Merit] = field(default_factory=list)
    steps: Diagnosis | None = None
    rejected_steps: int = 0
    suggestions: Sequence[str] = field(default_factory=list)
    errors: Errors = field(default_factory=dict)
    verdict: Words = "not compared"
    reference_time_s: float | None = None
    reference_uncertainty: float | None = None
    reference_method: str = MONOLITHIC
    witness: WitnessComparison | None = None


@dataclass(frozen=True)
class Summary:
    """What a run came to. An incomplete one has what is known."""

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
    message: Words = Ending.message
    verdict: Words = Assessment.verdict
    largest_error: str = ""
    exit_status: int = FAILED
    macro_steps: int = 0
    rejected_steps: int = 0
    iterations: int = 0
    do_steps: int | None = None
    wall_time_s: float = 0.0
    coupled_time_s: float = 0.0
    reference_time_s: float | None = None
    reference_uncertainty: float | None = None
    reference_method: str = Assessment.reference_method
    witness: WitnessComparison | None = None
    errors: Errors = field(default_factory=dict)
    contacts: ContactSummaries = field(default_factory=dict)
    contacts_from: str = MACRO_STEPS
    merits: Sequence[str] = field(default_factory=list)
    energy: Account | None = None
    steps: Diagnosis | None = None
    suggestions: Sequence[str] = field(default_factory=list)
    warnings: Mapping[str, Warnings] = field(default_factory=dict)
    not_finite: Mapping[str, float] = field(default_factory=dict)
    python_sweeps: Mapping[str, str] = field(default_factory=dict)
    without_rates: Sequence[str] = ()
    unproven: Sequence[str] = ()
    fmus: dict[str, str] = field(default_factory=dict)
    notices: Sequence[Words] = field(default_factory=list)

    def tell(self) -> list[Words]:
        """What trains, contacts, energies and steps came to, and warnings of FMUs, in words."""
        lines: list[Words] = [
            *self.merits,
            *contact_lines(self.contacts, self.contacts_from, self.fixed_steps),
        ]
        lines += energy_lines(self.energy) if self.energy else []
        lines += brief(self.steps, self.suggestions) if self.steps else []
        for name, given in self.warnings.items():
            first = f", the first: {given.first}" if given.first else "; it does not say of what"
            lines.append(f"{name}: the FMU gave {given.count} warning{'s' * (given.count > 1)}{first}")
        lines += self.unproven
        if self.without_rates:
            lines.append(
                f"{', '.join(self.without_rates)}: rates of change are no numbers at the start, so signals "
                "go through values only"
            )
        for name, since in self.not_finite.items():
            lines.append(
                f"{name}: not finite from t = {since:.6g} s on, or at times; look at its participant"
            )
        return lines

    def content(self) -> dict[str, Any]:
        """As plain JSON values."""
        message, verdict = map(in_command_line, (self.message, self.verdict))
        content = asdict(replace(self, message=message, verdict=verdict))
        for contact in content["contacts"].values():
            contact["film"] = contact["film"] if contact["film"] >= ATOM else 0.0
        content["notices"] = list(map(in_command_line, [*self.notices, *self.tell()]))
        for name, error in self.errors.items():
            own = content["errors"][name].pop("uncertainty")
            content["errors"][name] |= {
                "reference_uncertainty": own["relative_rms"],
                "below_reference_uncertainty": error.below_uncertainty,
                "within_tolerance": error.within if error.tolerance is not None else None,
            }
        return _replace_infinite(content)

    def write(self, path: Path) -> None:
        atomic_write.replace(path, (json.dumps(self.content(), indent=2, allow_nan=False) + "\n").encode())


def summarise(
    plan: Plan, ending: Ending, record: Record, assessment: Assessment | None = None, seconds: float = 0.0
) -> Summary:
    """The summary of a run of so many seconds that ended so."""
    scenario = plan.scenario
    found = vars(record) | (vars(assessment) if assessment else {})
    del found["ending"]
    found.pop("figures_of_merit", None)  # a table of its own
    return Summary(
        scenario=scenario.name,
        description=scenario.description,
        version=metadata.version("tribocosim"),
        master=scenario.master.model_dump(),
        macro_step=scenario.macro_step,
        fixed_steps=plan.fixed_steps,
        tolerance=dict(plan.tolerance),
        figures=plan.figures,
        fmus=plan.sha256,
        notices=plan.notices,
        wall_time_s=seconds,
        largest_error=describe_largest(assessment.errors) if assessment else "",
        **vars(ending),
        **found,
    )


def _replace_infinite(value: Any) -> Any:
    """JSON has no infinity and no NaN: null instead."""
    if isinstance(value, dict):
        return {str(key): _replace_infinite(item) for key, item in value.items()}
    if isinstance(value, (list, tuple)):
        return [_replace_infinite(item) for item in value]
    if isinstance(value, (bool, int, str, type(None))):
        return value
    number = float(value)
    return number if math.isfinite(number) else None
