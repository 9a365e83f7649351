"""What a run is worth: its contacts, its steps, and its errors against the reference."""

from collections.abc import Sequence
from dataclasses import dataclass, field

from ..assessment.contacts import ContactSummaries
from ..assessment.diagnosis import Diagnosis
from ..assessment.merits import Merit
from ..errors import Words
from .comparison import Errors
from .plan import MONOLITHIC
from .record import Ending
from .witness import WitnessComparison

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
