"""FMU of a spring stop."""

from ..fmi.description import Experiment
from ..fmi.terminals import Terminal

EXPERIMENT = Experiment(stop_time=1.0, step_size=1e-4)

TERMINALS = {
    "end": Terminal(
        "translation",
        "what strikes it",
        {"position": "position", "velocity": "velocity", "force": "force"},
    ),
}
