"""FMU of the slider-crank with clearance."""

import numpy as np

from ..fmi.description import Experiment
from ..reference_results.stimulus import Stimulus

# Ten turns at 1000 rpm.
EXPERIMENT = Experiment(stop_time=0.6, step_size=1e-5)


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
