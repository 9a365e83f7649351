"""FMU of the pivot friction."""

from ..fmi.description import Experiment
from ..fmi.terminals import Terminal

EXPERIMENT = Experiment(stop_time=0.1, step_size=1e-5)

TERMINALS = {
    "lever": Terminal(
        "pivot_friction",
        "the lever on the pivot",
        {"speed": "rotation_rate", "load": "load", "torque": "friction_torque"},
    ),
}
