"""FMU of the pad friction."""

from ..fmi.description import Experiment
from ..fmi.terminals import Terminal

EXPERIMENT = Experiment(stop_time=0.1, step_size=1e-5)

TERMINALS = {
    "pad": Terminal(
        "pad_friction",
        "the pad and its contact",
        {"velocity": "sliding_velocity", "load": "load", "force": "friction_force"},
    ),
}
