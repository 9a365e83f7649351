"""Stimuli of the FMUs' reference results: for each component a function of its name, in one of the rooms."""

from ..reference_results.stimulus import Stimulus
from . import engine, friction, oscillators, valve_train

# Components that have the stimulus of another.
ALIKE = {
    "needle_bearing": "pivot_friction",
}


def find_stimulus(name: str) -> Stimulus | None:
    """That of the component; None where it has none."""
    called = ALIKE.get(name, name)
    rooms = (valve_train, friction, engine, oscillators)
    return next((getattr(room, called)() for room in rooms if hasattr(room, called)), None)
