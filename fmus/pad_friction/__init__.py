"""FMU of the pad friction."""

import numpy as np

from ..reference_results.stimulus import Stimulus

TIMES = np.arange(51) * 1e-3

STIMULUS = Stimulus(
    says=(
        "A pad that slides to and fro with 0.6 m/s at most and slower and slower, under 300 to 700 N: it "
        "slides, turns back, and sticks."
    ),
    corners=TIMES,
    inputs={
        "sliding_velocity": 0.6 * np.exp(-TIMES / 5e-3) * np.cos(2.0 * np.pi * TIMES / 0.012),
        "load": 500.0 + 200.0 * np.sin(2.0 * np.pi * TIMES / 0.031),
    },
    step_size=1e-5,
    interval=5e-4,
    outputs=("friction_force", "sticking_margin", "slip", "power_loss"),
)
