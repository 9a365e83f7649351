"""Macro step sizes: fixed, or controlled by an error estimate, with or without rollback."""

from ..engine.step import REASONS, STOP, Step
from ..masters import Master, find_name
from ..masters.gauss_seidel import GaussSeidel
from .controlled import JUDGES, ControlledSteps, StepControl
from .estimators import ESTIMATORS
from .fixed import FixedSteps, RefinedSteps
from .forward import ForwardSteps
from .indicators import INDICATORS
from .locator import list_event_outputs
from .protocol import Stepper

__all__ = [
    "INDICATORS", "JUDGES", "REASONS", "STOP", "ControlledSteps", "FixedSteps", "ForwardSteps",
    "RefinedSteps", "Step", "StepControl", "Stepper", "check_estimator", "control_steps",
    "list_event_outputs",
]  # fmt: skip


def check_estimator(name: str, master: Master) -> None:
    """ValueError, with the remedy, if this estimator or indicator cannot judge that master."""
    if name in ESTIMATORS:
        ESTIMATORS[name]().check(master)
    elif master.implicit:
        raise ValueError(
            f"estimator = {name!r}: judges steps that are made once; {find_name(master)} repeats them: use "
            "predictor_corrector or step_doubling"
        )
    elif name == "residual_energy" and isinstance(master, GaussSeidel):
        # Measured on two masses: at equal work the error is 6 to 12 times that of equal steps.
        raise ValueError(
            f"estimator = {name!r}: with {find_name(master)} one variable of each bond is known at the end "
            "of a step, and the power sees no error while that one is zero: use defect, or the master jacobi"
        )


def control_steps(first_step: float, control: StepControl) -> ControlledSteps | ForwardSteps:
    """Steps controlled by the estimator that is named."""
    return (ForwardSteps if control.estimator in INDICATORS else ControlledSteps)(first_step, control)
