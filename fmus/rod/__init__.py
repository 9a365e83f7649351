"""FMU of the rod."""

from ..fmi.description import Experiment
from ..fmi.terminals import Terminal

# Two hundred periods of the default rod between rigid ends.
EXPERIMENT = Experiment(stop_time=0.02, step_size=2e-6)

TERMINALS = {
    "lower": Terminal(
        "translation",
        "the body below",
        {"position": "lower_position", "velocity": "lower_velocity", "force": "lower_force"},
    ),
    "upper": Terminal(
        "translation",
        "the body above",
        {"position": "upper_position", "velocity": "upper_velocity", "force": "upper_force"},
    ),
}
