"""FMU of the pin bearing."""

import numpy as np

from ..reference_results.stimulus import Stimulus

TIMES = np.arange(51) * 1e-3

STIMULUS = Stimulus(
    says="A roller at 300 to 500 rad/s on its pin under 200 to 1000 N, from the middle of its clearance.",
    corners=TIMES,
    inputs={
        "rotation_rate": 400.0 + 100.0 * np.sin(2.0 * np.pi * TIMES / 0.02),
        "applied_load": 600.0 - 400.0 * np.cos(2.0 * np.pi * TIMES / 0.024),
    },
    step_size=1e-5,
    interval=5e-4,
    outputs=(
        "friction_torque",
        "eccentricity_ratio",
        "minimum_film_thickness",
        "asperity_load",
        "power_loss",
    ),
)
