"""FMU of the quarter car's chassis."""

from ..description import Experiment

EXPERIMENT = Experiment(stop_time=4.0, step_size=1e-3)
