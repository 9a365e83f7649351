"""FMU of a mass under gravity and a force."""

from ..description import Experiment

EXPERIMENT = Experiment(stop_time=1.0, step_size=1e-4)
