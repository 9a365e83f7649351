"""FMU of the finger."""

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
    "tip": Terminal(
        "film_contact",
        "film between the lever's pad and the valve",
        {
            "position": "tip_position",
            "velocity": "tip_velocity",
            "entraining_velocity": "tip_entraining_velocity",
            "sliding_velocity": "tip_sliding_velocity",
            "radius_of_curvature": "tip_contact_radius",
            "load": "tip_load",
            "friction_force": "tip_friction",
        },
    ),
    "pivot": Terminal(
        "translation",
        "the lash adjuster under the pivot",
        {"position": "pivot_position", "velocity": "pivot_velocity", "force": "pivot_force"},
    ),
    "pivot_friction": Terminal(
        "pivot_friction",
        "friction of the pivot",
        {"speed": "rotation_rate", "load": "support_force", "torque": "pivot_torque"},
    ),
}
