"""FMU of the shaft with cams."""

from ..fmi.description import Experiment
from ..fmi.terminals import Terminal

# Two turns at 1000 rpm.
EXPERIMENT = Experiment(stop_time=0.12, step_size=1e-5)

TERMINALS = {
    "drive": Terminal(
        "rotation",
        "turned by a shaft",
        {
            "angle": "drive_angle",
            "speed": "drive_speed",
            "acceleration": "drive_acceleration",
            "torque": "drive_torque",
        },
    ),
    "cam[*]": Terminal(
        "cam_on_shaft",
        "a cam",
        {
            "angle": "cam_angle[*]",
            "speed": "cam_speed[*]",
            "torque": "cam_torque[*]",
            "x": "axis_x[*]",
            "y": "axis_y[*]",
            "velocity_x": "axis_velocity_x[*]",
            "velocity_y": "axis_velocity_y[*]",
            "force_x": "cam_force_x[*]",
            "force_y": "cam_force_y[*]",
        },
        partial=True,
    ),
}
