"""FMU of the slider-crank with clearance."""

from ..fmi.description import Experiment
from ..fmi.terminals import Terminal
from ..terminal_kinds import CRANK

# Ten turns at 1000 rpm.
EXPERIMENT = Experiment(stop_time=0.6, step_size=1e-5)

_WALL = {
    "entraining_velocity": "wall_entraining_velocity",
    "sliding_velocity": "wall_sliding_velocity",
    "radius_of_curvature": "wall_radius",
}
TERMINALS = {"crank": CRANK} | {
    f"{side}_wall": Terminal(
        "film_on_wall",
        f"film on the {side} wall",
        {"load": f"{side}_wall_force", **_WALL, "film_thickness": f"{side}_film_thickness"},
    )
    for side in ("upper", "lower")
}
