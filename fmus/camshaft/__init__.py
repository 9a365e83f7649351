"""FMU of the camshaft."""

from ..fmi.description import Experiment
from ..fmi.terminals import Terminal

# Two turns of the cam at 1000 rpm of the crank.
EXPERIMENT = Experiment(stop_time=0.24, step_size=1e-5)

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
    "contact": Terminal(
        "film_contact",
        "surface of the cam under the follower",
        {
            "position": "surface_position",
            "velocity": "surface_velocity",
            "entraining_velocity": "entraining_velocity",
            "sliding_velocity": "sliding_velocity",
            "radius_of_curvature": "radius_of_curvature",
            "load": "contact_load",
            "friction_force": "friction_force",
        },
    ),
}
