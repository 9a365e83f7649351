"""FMU of the valve on its spring."""

from ..description import Experiment

# Fifty periods of the default spring's surge.
EXPERIMENT = Experiment(stop_time=0.1, step_size=1e-5)
