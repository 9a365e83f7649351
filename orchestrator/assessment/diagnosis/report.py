"""The diagnosis of a run from its output folder."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from ...errors import MistakeError
from ...scenario import Scenario, ScenarioError
from ...scenario.files import load
from ...store.output_folder import SCENARIO, SUMMARY
from ...texts import parse_json, read_text
from .facts import Facts
from .numbers import Diagnosis, diagnose_steps
from .steps import Steps, read_steps
from .suggestions import suggestions
from .text import full


@dataclass(frozen=True)
class Findings:
    """The steps of a run, its scenario, what limited them, what would help, and the lines of the report."""

    steps: Steps
    scenario: Scenario
    diagnosis: Diagnosis
    suggestions: Sequence[str]
    lines: Sequence[str]


def diagnose(out: Path) -> Findings:
    """Of the run in `out`; MistakeError without a run."""
    steps, message = read_steps(out)
    diagnosis = diagnose_steps(steps, _do_steps(out / SUMMARY))
    if diagnosis is None:
        raise MistakeError(f"{out}: the run made no step ({message})")
    if not (out / SCENARIO).is_file():
        raise MistakeError(f"{out}: there is no {SCENARIO}, with which the steps are judged; put it back")
    try:
        scenario = load(out / SCENARIO)
    except ScenarioError as error:
        raise MistakeError(f"{error}; the steps are judged with the scenario of the run") from None
    facts = Facts(diagnosis, steps, scenario)
    remedies = suggestions(facts)
    return Findings(steps, scenario, diagnosis, remedies, full(facts, remedies, message))


def _do_steps(summary: Path) -> int | None:
    """As the run's summary says, if it does."""
    try:
        found = parse_json(read_text(summary)).get("do_steps")
    except (OSError, ValueError):
        return None
    return int(found) if isinstance(found, int) else None
