"""FMU of a mass with the spring that couples it to another."""

from ..description import Experiment

EXPERIMENT = Experiment(stop_time=10.0, step_size=1e-3)
