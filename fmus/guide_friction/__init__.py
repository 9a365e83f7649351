"""FMU of the guide friction."""

import numpy as np

from ..reference_results.stimulus import Stimulus

TIMES = np.arange(51) * 1e-3

STIMULUS = Stimulus(
    says="A valve that moves to and fro with 2 m/s at most and rests, under up to 100 N and 2 N m.",
    corners=TIMES,
    inputs={
        "velocity": 2.0 * np.exp(-TIMES / 5e-3) * np.cos(2.0 * np.pi * TIMES / 0.012),
        "side_force": 100.0 * np.sin(2.0 * np.pi * TIMES / 0.031),
        "side_moment": 2.0 * np.cos(2.0 * np.pi * TIMES / 0.023),
    },
    step_size=1e-5,
    interval=5e-4,
    outputs=("friction_force", "viscous_friction", "near_load", "far_load", "sticking_margin", "power_loss"),
)
