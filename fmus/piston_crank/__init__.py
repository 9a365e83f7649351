"""FMU of the slider-crank with a tilting piston on a driven crank."""

import numpy as np

from ..reference_results.stimulus import Stimulus

SPEED = 200.0  # rad/s
TIMES = np.arange(64) * 1e-3
ANGLE = SPEED * TIMES


def gas(angle: np.ndarray) -> np.ndarray:
    """A firing pressure over the crank angle, zero elsewhere in the four-stroke cycle; Pa."""
    after = np.mod(angle + np.pi, 4.0 * np.pi) - np.pi
    return 3e6 * np.exp(-(((after - 0.3) / 0.5) ** 2))


STIMULUS = Stimulus(
    says=(
        "One four-stroke cycle at 200 rad/s under a firing pressure of 3 MPa: the piston tilts and "
        "goes from wall to wall, each arrival a sequence of impacts of its corners that ends in "
        "sliding. Between arrivals nothing of these sequences is left, so that errors do not grow."
    ),
    corners=TIMES,
    inputs={"crank_angle": ANGLE, "crank_speed": SPEED + 0.0 * TIMES, "gas_pressure": gas(ANGLE)},
    step_size=1e-5,
    interval=7e-4,
    outputs=(
        "piston_offset", "piston_tilt", "piston_tilt_rate", "lower_front_force", "wall_friction_force",
        "pin_force_along", "impact_count", "impact_loss", "crank_torque",
    ),
)  # fmt: skip
