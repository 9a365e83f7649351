"""FMU of the slider-crank with clearance."""

from ..fmi.description import Experiment
from ..fmi.terminals import Terminal

# Ten turns at 1000 rpm.
EXPERIMENT = Experiment(stop_time=0.6, step_size=1e-5)

_WALL = {
    "entraining_velocity": "wall_entraining_velocity",
    "sliding_velocity": "wall_sliding_velocity",
    "radius_of_curvature": "wall_radius",
}
TERMINALS = {
    "crank": Terminal(
        "rotation",
        "turned by a shaft",
        {
            "angle": "crank_angle",
            "speed": "crank_speed",
            "acceleration": "crank_acceleration",
            "torque": "crank_torque",
            "impulse": "crank_impact_impulse",
        },
    ),
} | {
    f"{side}_wall": Terminal(
        "film_on_wall",
        f"film on the {side} wall",
        {"load": f"{side}_wall_force", **_WALL, "film_thickness": f"{side}_film_thickness"},
    )
    for side in ("upper", "lower")
}
