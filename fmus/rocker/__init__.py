"""FMU of the rocker."""

import numpy as np

from ..reference_results.stimulus import Stimulus

TIMES = np.arange(41) * 1e-3


def _force(t: np.ndarray) -> np.ndarray:
    """What balances the valve's load, with a swing of 12 deg forth and back; N."""
    w = np.pi / 0.02
    moment = 6e-5 * 0.1 * 4.0 * w**2 * np.cos(2.0 * w * t)
    return 1.25 * 400.0 + moment / 32e-3


STIMULUS = Stimulus(
    says=(
        "A pushrod's force that swings the lever by 12 deg twice, against 400 N on the valve, whose "
        "friction is 5 % of it, as broken lines."
    ),
    corners=TIMES,
    inputs={
        "rod_force": _force(TIMES),
        "tip_load": 400.0 + 0.0 * TIMES,
        "tip_friction": 20.0 * np.sin(np.pi * TIMES / 0.01),
    },
    step_size=1e-4,
    interval=4e-4,
    outputs=(
        "rotation", "rod_position", "rod_velocity", "tip_position", "tip_velocity", "tip_entraining_velocity",
        "tip_sliding_velocity", "pivot_force",
    ),
)  # fmt: skip
