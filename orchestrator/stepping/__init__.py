"""Macro step sizes: fixed, or controlled by an error estimate, with or without rollback."""

from ..engine.step import REASONS, STOP, Step
from .controlled import DEFECT, JUDGES, ControlledSteps, StepControl, check_estimator
from .fixed import FixedSteps, RefinedSteps
from .forward import ForwardSteps
from .locator import list_event_outputs

__all__ = [
    "DEFECT", "JUDGES", "REASONS", "STOP", "ControlledSteps", "FixedSteps", "ForwardSteps",
    "RefinedSteps", "Step", "StepControl", "Stepper", "check_estimator", "control_steps",
    "list_event_outputs",
]  # fmt: skip


# Makes macro steps one after the other.
Stepper = FixedSteps | ControlledSteps | ForwardSteps


def control_steps(first_step: float, control: StepControl) -> ControlledSteps | ForwardSteps:
    """Steps controlled by the estimator that is named."""
    return (ForwardSteps if control.estimator == DEFECT else ControlledSteps)(first_step, control)
