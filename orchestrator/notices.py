"""What of a scenario has no effect, or none that is seen: no mistake, but hardly what was meant."""

from __future__ import annotations

from .abilities import unsynchronised
from .scenario import Scenario


def notices(scenario: Scenario) -> list[str]:
    """A line for each."""
    found = []
    if scenario.step_control and scenario.output_step is not None:
        found.append(
            f"output_step = {scenario.output_step:g} s: is not used, for with [step_control] every step is "
            "recorded; leave it out"
        )
    if scenario.energy.correction and not scenario.energy.ledger:
        found.append(
            "energy.correction = true: nothing counts what it gives back; energy.ledger = true shows it"
        )
    return found + unsynchronised(scenario)
