"""Ways to choose macro steps: fixed, or controlled by an error estimate; both can locate events."""

from ..engine.step import REASONS, STOP, Step
from .controlled import ControlledSteps, StepControl
from .fixed import FixedSteps
from .locator import list_event_outputs
from .protocol import Stepper

__all__ = [
    "REASONS",
    "STOP",
    "ControlledSteps",
    "FixedSteps",
    "Step",
    "StepControl",
    "Stepper",
    "list_event_outputs",
]
