"""FMU of the pivot friction."""

import numpy as np

from ..reference_results.stimulus import Stimulus

TIMES = np.arange(51) * 1e-3

STIMULUS = Stimulus(
    says=(
        "A lever that swings with 30 rad/s at most and slower and slower, on a pivot under 600 to 1400 N: it "
        "slides, turns back, and sticks."
    ),
    corners=TIMES,
    inputs={
        "rotation_rate": 30.0 * np.exp(-TIMES / 5e-3) * np.cos(2.0 * np.pi * TIMES / 0.012),
        "load": 1000.0 + 400.0 * np.sin(2.0 * np.pi * TIMES / 0.031),
    },
    step_size=1e-5,
    interval=5e-4,
    outputs=("friction_torque", "sliding_torque", "sticking_margin", "sliding_rate", "power_loss"),
)
