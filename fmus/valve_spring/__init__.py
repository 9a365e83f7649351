"""FMU of the valve on its spring."""

from ..fmi.description import Experiment
from ..fmi.terminals import Terminal

# Fifty periods of the default spring's surge.
EXPERIMENT = Experiment(stop_time=0.1, step_size=1e-5)

TERMINALS = {
    "load": Terminal(
        "translation",
        "the follower that a contact loads",
        {"position": "position", "velocity": "velocity", "force": "load"},
    ),
    "gas": Terminal("gas_force", "gas on the head", {"force": "gas_force"}),
}
