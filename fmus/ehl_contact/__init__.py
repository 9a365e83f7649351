"""FMU of the lubricated line contact."""

from ..fmi.description import Experiment
from ..fmi.terminals import Terminal

EXPERIMENT = Experiment(stop_time=0.1, step_size=1e-5)

TERMINALS = {
    "driver": Terminal(
        "film_contact",
        "film on the surface that approaches",
        {
            "position": "approach",
            "velocity": "approach_rate",
            "entraining_velocity": "entraining_velocity",
            "sliding_velocity": "sliding_velocity",
            "radius_of_curvature": "radius_of_curvature",
            "load": "load",
            "friction_force": "friction_force",
        },
    ),
    "follower": Terminal(
        "translation",
        "the body that the film lifts",
        {"position": "retreat", "velocity": "retreat_rate", "force": "load"},
    ),
    "wall": Terminal(
        "film_on_wall",
        "film under a given load",
        {
            "load": "applied_load",
            "entraining_velocity": "entraining_velocity",
            "sliding_velocity": "sliding_velocity",
            "radius_of_curvature": "radius_of_curvature",
            "film_thickness": "film_thickness",
        },
    ),
}
