"""FMU of the coil spring."""

from ..fmi.description import Experiment
from ..fmi.terminals import Terminal

# Fifty periods of the default spring's surge.
EXPERIMENT = Experiment(stop_time=0.1, step_size=1e-5)

TERMINALS = {
    "end": Terminal(
        "translation",
        "the moving end",
        {"position": "position", "velocity": "velocity", "force": "force"},
    ),
}
