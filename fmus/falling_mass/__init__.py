"""FMU of a mass under gravity and a force."""

from ..fmi.description import Experiment
from ..fmi.terminals import Terminal

EXPERIMENT = Experiment(stop_time=1.0, step_size=1e-4)

TERMINALS = {
    "end": Terminal(
        "translation",
        "what the force comes from",
        {"position": "position", "velocity": "velocity", "force": "force"},
    ),
}
