"""FMU of the lubricated line contact."""

from ..fmi.description import Experiment
from ..fmi.terminals import Terminal
from ..terminal_kinds import film_contact, translation

EXPERIMENT = Experiment(stop_time=0.1, step_size=1e-5)

TERMINALS = {
    "driver": film_contact(
        "film on the surface that approaches", "approach", "approach_rate", "load", "friction_force"
    ),
    "follower": translation("the body that the film lifts", "retreat", "retreat_rate", "load"),
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
