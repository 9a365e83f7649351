"""Estimators of a macro step's local error. To add one, write a file with a class and list it here.

The estimator makes the step, because most compute it more than once.
"""

from .energy import EnergyResidual
from .predictor_corrector import PredictorCorrector
from .protocol import Attempt, Estimator
from .schierz import Schierz
from .step_doubling import StepDoubling

ESTIMATORS: dict[str, type[Estimator]] = {
    "step_doubling": StepDoubling,
    "schierz": Schierz,
    "predictor_corrector": PredictorCorrector,
    "energy": EnergyResidual,
}

__all__ = ["ESTIMATORS", "Attempt", "Estimator"]
