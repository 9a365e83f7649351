"""Macro step sizes: fixed, or controlled by an error estimate, with or without rollback."""

from ..engine.step import REASONS, STOP, Step
from ..masters import Master, find_name
from .controlled import DEFECT, JUDGES, ControlledSteps, StepControl
from .estimators import ESTIMATORS
from .fixed import FixedSteps, RefinedSteps
from .forward import ForwardSteps
from .locator import list_event_outputs
from .protocol import Stepper

__all__ = [
    "DEFECT", "JUDGES", "REASONS", "STOP", "ControlledSteps", "FixedSteps", "ForwardSteps",
    "RefinedSteps", "Step", "StepControl", "Stepper", "check_estimator", "control_steps",
    "list_event_outputs",
]  # fmt: skip


def check_estimator(name: str, master: Master) -> None:
    """ValueError, with the remedy, if this estimator cannot judge that master."""
    if name in ESTIMATORS:
        ESTIMATORS[name]().check(master)
    elif master.implicit:
        raise ValueError(
            f"estimator = {name!r}: judges steps that are made once; {find_name(master)} repeats them: use "
            "predictor_corrector or step_doubling"
        )


def control_steps(first_step: float, control: StepControl) -> ControlledSteps | ForwardSteps:
    """Steps controlled by the estimator that is named."""
    return (ForwardSteps if control.estimator == DEFECT else ControlledSteps)(first_step, control)
