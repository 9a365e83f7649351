"""FMU of a mass on a spring, driven by a force."""

from ..description import Experiment

EXPERIMENT = Experiment(stop_time=10.0, step_size=1e-3)
