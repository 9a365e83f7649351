"""FMU of the lash adjuster."""

import numpy as np

from ..reference_results.stimulus import Stimulus

CORNERS = np.array([0.0, 4e-3, 8e-3, 30e-3, 34e-3, 60e-3])
LOWER = np.array([0.0, 0.0, 40e-6, 40e-6, 0.0, 0.0])
RATE = np.array([0.0, 5e-3, 5e-3, 0.0, 0.0, 0.0])

STIMULUS = Stimulus(
    says=(
        "The chamber is compressed by 40 um within 4 ms, leaks down, is released, draws oil through its "
        "check valve, and fills up."
    ),
    corners=CORNERS,
    inputs={"lower_position": LOWER, "lower_velocity": RATE},
    step_size=1e-4,
    interval=1e-3,
    outputs=("force", "pressure", "extension", "leak_flow", "valve_flow", "valve_excess"),
)
