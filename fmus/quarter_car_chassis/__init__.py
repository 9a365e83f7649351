"""FMU of the quarter car's chassis."""

from ..fmi.description import Experiment
from ..fmi.terminals import Terminal

EXPERIMENT = Experiment(stop_time=4.0, step_size=1e-3)

TERMINALS = {
    "suspension": Terminal(
        "suspension",
        "to the wheel",
        {
            "wheel_position": "wheel_position",
            "wheel_velocity": "wheel_velocity",
            "chassis_position": "position",
            "chassis_velocity": "velocity",
        },
    ),
}
