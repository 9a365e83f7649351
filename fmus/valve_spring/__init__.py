"""FMU of the valve on its spring."""

import numpy as np

from ..reference_results.stimulus import Stimulus

BEGIN, DURATION, LIFT = 4e-3, 32e-3, 8e-3
TIMES = np.arange(41) * 1e-3


def _load(t: np.ndarray) -> np.ndarray:
    """What lifts the valve along sin^2: preload, rate and inertia of the defaults; N."""
    w = np.pi / DURATION
    s = np.clip((t - BEGIN) / DURATION, 0.0, 1.0)
    moving = (t > BEGIN) & (t < BEGIN + DURATION)
    return (
        330.0
        + 35e3 * LIFT * np.sin(np.pi * s) ** 2
        + moving * 0.25 * LIFT * 2.0 * w**2 * np.cos(2.0 * w * (t - BEGIN))
    )


STIMULUS = Stimulus(
    says=(
        "A valve's lift of 8 mm in 32 ms by the force that it takes, as a broken line whose corners "
        "excite surge of the coils; then 4 ms of free vibration."
    ),
    corners=TIMES,
    inputs={"load": _load(TIMES)},
    step_size=1e-5,
    interval=4e-4,
    outputs=("position", "velocity", "acceleration", "spring_force", "coil_position[1]", "coil_position[2]"),
)
