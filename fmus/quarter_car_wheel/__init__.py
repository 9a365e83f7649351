"""FMU of the quarter car's wheel."""

from ..description import Experiment

EXPERIMENT = Experiment(stop_time=4.0, step_size=1e-3)
