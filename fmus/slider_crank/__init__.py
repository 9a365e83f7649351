"""FMU of the slider-crank with clearance."""

import numpy as np

from ..fmi.description import Experiment
from ..fmi.terminals import Terminal
from ..reference_results.stimulus import Stimulus
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

SPEED = 100.0  # rad/s
TIMES = np.arange(91) * 2e-3

STIMULUS = Stimulus(
    says=(
        "Nearly three turns of the crank at 100 rad/s, from the middle of the clearance: flights and "
        "impacts on both walls, which films of up to 20 um narrow. The motion is chaotic in the long "
        "run; until 0.18 s, its horizon here, errors grow less than a thousandfold."
    ),
    corners=TIMES,
    inputs={
        "crank_angle": SPEED * TIMES,
        "crank_speed": SPEED + 0.0 * TIMES,
        "upper_film_thickness": 2e-5 * np.sin(np.pi * TIMES / 0.09) ** 2,
        "lower_film_thickness": 1e-5 * np.clip(TIMES / 0.1, 0.0, 1.0),
    },
    step_size=1e-4,
    interval=2e-3,
    outputs=(
        "psi", "psi_rate", "piston_offset", "crank_torque", "impact_count", "upper_wall_impulse",
        "lower_wall_impulse", "last_impact_time", "last_impact_velocity",
    ),
)  # fmt: skip
