"""FMU of the lash adjuster."""

from ..fmi.description import Experiment
from ..fmi.terminals import Terminal

# Two and a half times the time in which the default chamber relaxes.
EXPERIMENT = Experiment(stop_time=0.1, step_size=1e-5)

TERMINALS = {
    "lower": Terminal(
        "translation",
        "the body below",
        {"position": "lower_position", "velocity": "lower_velocity", "force": "force"},
    ),
    "upper": Terminal(
        "translation",
        "the body above",
        {"position": "upper_position", "velocity": "upper_velocity", "force": "force"},
    ),
}
