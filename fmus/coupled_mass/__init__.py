"""FMU of a mass with the spring that couples it to another."""

from ..fmi.description import Experiment
from ..fmi.terminals import Terminal

EXPERIMENT = Experiment(stop_time=10.0, step_size=1e-3)

TERMINALS = {
    "other": Terminal(
        "translation",
        "the mass at the spring's other end",
        {"position": "other_position", "velocity": "other_velocity", "force": "force"},
    ),
}
