"""FMU of the lubricated line contact."""

from ..fmi.description import Experiment
from ..fmi.terminals import Terminal

# With a pressure field, so that the film may be solved for. Formulas do not touch it.
STRUCTURE = {"nodes": 301}
EXPERIMENT = Experiment(stop_time=0.1, step_size=1e-5)
# In machine code the film follows formulas.
NATIVE_STRUCTURE = {"nodes": 0}
ONLY_IN_PYTHON = {
    "nodes": "native FMUs of ehl_contact have no pressure field, their film follows formulas; leave the size "
    "out, or take the FMU in Python, which has one"
}
# A pressure field does not touch formulas, of which the reference results are.
ALIKE = (STRUCTURE,)

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
