"""FMU of a spring stop."""

from ..description import Experiment

EXPERIMENT = Experiment(stop_time=1.0, step_size=1e-4)
