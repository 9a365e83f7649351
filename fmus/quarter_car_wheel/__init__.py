"""FMU of the quarter car's wheel."""

from ..fmi.description import Experiment
from ..fmi.terminals import Terminal

EXPERIMENT = Experiment(stop_time=4.0, step_size=1e-3)

TERMINALS = {
    "suspension": Terminal(
        "suspension",
        "to the chassis",
        {
            "wheel_position": "position",
            "wheel_velocity": "velocity",
            "chassis_position": "chassis_position",
            "chassis_velocity": "chassis_velocity",
        },
    ),
}
