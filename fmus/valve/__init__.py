"""FMU of the valve on its seat."""

import numpy as np

from ..reference_results.stimulus import Stimulus

BEGIN, DURATION, LIFT = 2e-3, 16e-3, 4e-3
TIMES = np.arange(23) * 1e-3


def _load(t: np.ndarray) -> np.ndarray:
    """What moves 0.1 kg along sin^2 and back against the spring; N."""
    w = np.pi / DURATION
    moving = (t > BEGIN) & (t < BEGIN + DURATION)
    return _spring(t) - 60.0 + moving * (60.0 + 0.1 * LIFT * 2.0 * w**2 * np.cos(2.0 * w * (t - BEGIN)))


def _spring(t: np.ndarray) -> np.ndarray:
    s = np.clip((t - BEGIN) / DURATION, 0.0, 1.0)
    return np.asarray(300.0 + 35e3 * LIFT * np.sin(np.pi * s) ** 2)


STIMULUS = Stimulus(
    says=(
        "A valve that rests on its seat, is lifted by some 4 mm in 16 ms as a broken line, and lands on its "
        "seat again."
    ),
    corners=TIMES,
    inputs={"load": _load(TIMES), "spring_force[1]": _spring(TIMES)},
    step_size=1e-5,
    interval=2e-4,
    outputs=("position", "velocity", "acceleration", "seat_force", "seat_dip"),
)
