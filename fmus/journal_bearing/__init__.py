"""FMU of the journal bearing."""

import numpy as np

from ..reference_results.stimulus import Stimulus

SPEED = 100.0  # rad/s
TIMES = np.arange(81) * 1e-3
X = 8e-6 * np.sin(2.0 * np.pi * TIMES / 0.04)
Y = -32e-6 + 14e-6 * np.cos(2.0 * np.pi * TIMES / 0.02)


def _rate(place: np.ndarray) -> np.ndarray:
    return np.gradient(place, TIMES)


STIMULUS = Stimulus(
    says=(
        "A journal at 100 rad/s whose axis is pressed down by 18 to 46 um and moved to both sides, with a "
        "clearance of 25 um."
    ),
    corners=TIMES,
    inputs={
        "shaft_speed": SPEED + 0.0 * TIMES,
        "axis_x": X,
        "axis_y": Y,
        "axis_velocity_x": _rate(X),
        "axis_velocity_y": _rate(Y),
    },
    step_size=1e-5,
    interval=8e-4,
    outputs=(
        "force_x", "force_y", "friction_torque", "load", "eccentricity_ratio", "minimum_film_thickness",
        "film_ratio", "maximum_pressure", "asperity_load", "power_loss",
    ),
)  # fmt: skip
