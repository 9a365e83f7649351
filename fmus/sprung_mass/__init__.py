"""FMU of a mass on a spring, driven by a force."""

from ..fmi.description import Experiment
from ..fmi.terminals import Terminal

EXPERIMENT = Experiment(stop_time=10.0, step_size=1e-3)

TERMINALS = {
    "end": Terminal(
        "translation",
        "what the force comes from",
        {"position": "position", "velocity": "velocity", "force": "force"},
    ),
}
