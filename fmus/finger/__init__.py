"""FMU of the finger follower."""

import numpy as np

from ..reference_results.stimulus import Stimulus

SPEED = 50.0  # rad/s, of the cam
TIMES = np.arange(66) * 2e-3
# Load on the valve, and the ratio of the lever when closed (N, 1).
LOAD, RATIO = 2.0, 1.42069


def _turning(t: np.ndarray) -> np.ndarray:
    """A small part of the load on the cam, to and fro; N."""
    return 0.1 * np.sin(100.0 * t)


STIMULUS = Stimulus(
    says=(
        "A little more than one turn of the cam at 50 rad/s under the pad. The load on the cam goes to and "
        "fro about what balances 2 N on the valve; the pivot bears the rest."
    ),
    corners=TIMES,
    inputs={
        "cam_angle": SPEED * TIMES,
        "cam_speed": SPEED + 0.0 * TIMES,
        "cam_load": RATIO * LOAD + _turning(TIMES),
        "tip_load": LOAD + 0.0 * TIMES,
        "pivot_force": (RATIO - 1.0) * LOAD + 0.3 * _turning(TIMES),
    },
    step_size=1e-4,
    interval=2e-3,
    outputs=(
        "rotation", "pivot_position", "tip_position", "tip_velocity", "tip_sliding_velocity", "overlap",
        "sliding_velocity", "cam_torque", "ratio", "support_force",
    ),
)  # fmt: skip
