"""FMU of the coil spring."""

import numpy as np

from ..reference_results.stimulus import Stimulus

TIMES = np.arange(41) * 0.5e-3
LIFT, DURATION = 17e-3, 8e-3


def _position(t: np.ndarray) -> np.ndarray:
    return np.asarray(LIFT * np.sin(np.pi * np.clip(t / DURATION, 0.0, 1.0)) ** 2)


def _velocity(t: np.ndarray) -> np.ndarray:
    return np.asarray(LIFT * np.pi / DURATION * np.sin(2.0 * np.pi * np.clip(t / DURATION, 0.0, 1.0)))


STIMULUS = Stimulus(
    says=(
        "The moving end goes by 17 mm and back in 8 ms, as a broken line whose corners excite surge; some "
        "coils touch near the largest lift. Then 12 ms of free vibration."
    ),
    corners=TIMES,
    inputs={"position": _position(TIMES), "velocity": _velocity(TIMES)},
    step_size=1e-5,
    interval=2e-4,
    outputs=("force", "least_gap", "clash_force", "coil_position[1]", "coil_position[4]", "coil_position[8]"),
)
