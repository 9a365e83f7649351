"""FMU of the tappet."""

from ..fmi.description import Experiment
from ..fmi.terminals import Terminal

# Two turns of the cam at 1000 rpm.
EXPERIMENT = Experiment(stop_time=0.12, step_size=1e-5)

TERMINALS = {
    "cam": Terminal(
        "film_contact",
        "film between cam and follower",
        {
            "position": "overlap",
            "velocity": "overlap_rate",
            "entraining_velocity": "entraining_velocity",
            "sliding_velocity": "sliding_velocity",
            "radius_of_curvature": "radius_of_curvature",
            "load": "cam_load",
            "friction_force": "cam_friction",
        },
    ),
    "shaft": Terminal(
        "cam_on_shaft",
        "turned by a shaft",
        {
            "angle": "cam_angle",
            "speed": "cam_speed",
            "torque": "cam_torque",
            "x": "axis_x",
            "y": "axis_y",
            "velocity_x": "axis_velocity_x",
            "velocity_y": "axis_velocity_y",
            "force_x": "cam_force_x",
            "force_y": "cam_force_y",
        },
        partial=True,
    ),
    "train": Terminal(
        "translation",
        "what stands on the follower",
        {"position": "position", "velocity": "velocity", "force": "load"},
    ),
}
