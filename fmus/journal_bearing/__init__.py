"""FMU of the journal bearing."""

from ..fmi.description import Experiment
from ..fmi.terminals import Terminal

# Two turns at 1000 rpm.
EXPERIMENT = Experiment(stop_time=0.12, step_size=1e-5)

TERMINALS = {
    "shaft": Terminal(
        "cam_on_shaft",
        "turned by a shaft",
        {
            "speed": "shaft_speed",
            "torque": "friction_torque",
            "x": "axis_x",
            "y": "axis_y",
            "velocity_x": "axis_velocity_x",
            "velocity_y": "axis_velocity_y",
            "force_x": "force_x",
            "force_y": "force_y",
        },
        partial=True,
    ),
}
