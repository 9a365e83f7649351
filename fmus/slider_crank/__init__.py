"""FMU of the slider-crank with clearance."""

from ..description import Experiment

# Ten turns at 1000 rpm.
EXPERIMENT = Experiment(stop_time=0.6, step_size=1e-5)
