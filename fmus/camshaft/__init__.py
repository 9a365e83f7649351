"""FMU of the camshaft."""

import numpy as np

from ..fmi.description import Experiment
from ..reference_results.stimulus import Stimulus

# Two turns of the cam at 1000 rpm of the crank.
EXPERIMENT = Experiment(stop_time=0.24, step_size=1e-5)


SPEED = 50.0  # rad/s, of the cam
TIMES = np.arange(66) * 2e-3


def _load(t: np.ndarray) -> np.ndarray:
    """A valve train's: its spring at rest on the base circle, more over the lift; N."""
    return 330.0 + 280.0 * np.sin(np.pi * np.clip((t - 0.03) / 0.066, 0.0, 1.0)) ** 2


STIMULUS = Stimulus(
    says=(
        "A little more than one turn of the cam at 50 rad/s, rise, dwell and fall included, under a "
        "contact load that grows with the lift and friction of 5 % of it."
    ),
    corners=TIMES,
    inputs={
        "drive_angle": SPEED * TIMES,
        "drive_speed": SPEED + 0.0 * TIMES,
        "contact_load": _load(TIMES),
        "friction_force": 0.05 * _load(TIMES),
    },
    step_size=1e-4,
    interval=2e-3,
    outputs=(
        "cam_angle", "surface_position", "surface_velocity", "radius_of_curvature", "entraining_velocity",
        "sliding_velocity", "contact_offset", "drive_torque", "next_event",
    ),
)  # fmt: skip
