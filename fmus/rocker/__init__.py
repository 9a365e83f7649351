"""FMU of the rocker."""

from ..fmi.description import Experiment
from ..fmi.terminals import Terminal

EXPERIMENT = Experiment(stop_time=0.1, step_size=1e-5)

TERMINALS = {
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
    "rod": Terminal(
        "translation",
        "the pushrod's end",
        {"position": "rod_position", "velocity": "rod_velocity", "force": "rod_force"},
    ),
    "pivot_friction": Terminal(
        "pivot_friction",
        "friction of the pivot",
        {"speed": "rotation_rate", "load": "pivot_force", "torque": "pivot_torque"},
    ),
}
