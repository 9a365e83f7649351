"""FMU of the flywheel."""

from ..fmi.description import Experiment
from ..fmi.terminals import Terminal

EXPERIMENT = Experiment(stop_time=1.0, step_size=1e-3)

# Of mechanisms that have no impacts the impulse stays 0.
TERMINALS = {
    "load[*]": Terminal(
        "rotation",
        "a mechanism that the shaft turns",
        {
            "angle": "angle",
            "speed": "speed",
            "acceleration": "acceleration",
            "torque": "load_torque[*]",
            "impulse": "load_impulse[*]",
        },
        partial=True,
    ),
}
