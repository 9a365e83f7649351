"""FMU of the camshaft."""

from ..fmi.description import Experiment
from ..terminal_kinds import film_contact, rotation

# Two turns of the cam at 1000 rpm of the crank.
EXPERIMENT = Experiment(stop_time=0.24, step_size=1e-5)

TERMINALS = {
    "drive": rotation("drive"),
    "contact": film_contact(
        "surface of the cam under the follower",
        "surface_position", "surface_velocity", "contact_load", "friction_force",
    ),
}  # fmt: skip
