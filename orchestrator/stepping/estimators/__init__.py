"""Estimators of a macro step's local error. To add one: a file with a class, listed here.

An estimator makes the step, because most need more than one way through it.
"""

from __future__ import annotations

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
