"""FMU of the tappet."""

import numpy as np

from ..reference_results.stimulus import Stimulus

SPEED = 50.0  # rad/s, of the cam
TIMES = np.arange(66) * 2e-3


def _lifting(t: np.ndarray) -> np.ndarray:
    """What moves 0.1 kg along 8 mm sin^2 and back; N."""
    w = np.pi / 0.064
    moving = (t > 0.03) & (t < 0.094)
    return moving * 0.1 * 8e-3 * 2.0 * w**2 * np.cos(2.0 * w * (t - 0.03))


STIMULUS = Stimulus(
    says=(
        "A little more than one turn of the cam at 50 rad/s under a flat follower, whose load of 300 N is a "
        "little less or more than the train's, with friction of 5 % of it."
    ),
    corners=TIMES,
    inputs={
        "cam_angle": SPEED * TIMES,
        "cam_speed": SPEED + 0.0 * TIMES,
        "cam_load": 300.0 + _lifting(TIMES),
        "cam_friction": 15.0 + 0.0 * TIMES,
        "load": 300.0 + 0.0 * TIMES,
    },
    step_size=1e-4,
    interval=2e-3,
    outputs=(
        "position", "velocity", "overlap", "overlap_rate", "entraining_velocity", "sliding_velocity",
        "radius_of_curvature", "cam_torque", "next_event",
    ),
)  # fmt: skip
