"""FMU of the camshaft."""

from ..description import Experiment

# Two turns of the cam at 1000 rpm of the crank.
EXPERIMENT = Experiment(stop_time=0.24, step_size=1e-5)
