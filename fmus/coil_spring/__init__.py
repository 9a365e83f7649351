"""FMU of the coil spring."""

from ..fmi.description import Experiment
from ..terminal_kinds import translation

# Fifty periods of the default spring's surge.
EXPERIMENT = Experiment(stop_time=0.1, step_size=1e-5)

TERMINALS = {"end": translation("the moving end")}
