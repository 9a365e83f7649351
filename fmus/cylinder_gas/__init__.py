"""FMU of the gas pressure of a four-stroke cycle."""

from ..description import Experiment

# Two cycles at 2000 rpm.
EXPERIMENT = Experiment(stop_time=0.12, step_size=1e-5)
