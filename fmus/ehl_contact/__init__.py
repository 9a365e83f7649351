"""FMU of the lubricated line contact."""

from ..description import Experiment

EXPERIMENT = Experiment(stop_time=0.1, step_size=1e-5)
