"""FMU of the rod."""

import numpy as np

from ..fmi.description import Experiment
from ..reference_results.stimulus import Stimulus

# Two hundred periods of the default rod between rigid ends.
EXPERIMENT = Experiment(stop_time=0.02, step_size=2e-6)


TIMES = np.arange(21) * 1e-4
SQUEEZE, LENGTH = 20e-6, 2e-3


def _lower(t: np.ndarray) -> np.ndarray:
    return np.asarray(SQUEEZE * np.sin(np.pi * t / LENGTH) ** 2)


STIMULUS = Stimulus(
    says=(
        "The body below presses the rod by 20 um against one at rest and goes back, as a broken line "
        "whose corners excite waves. Then the ends part and touch again."
    ),
    corners=TIMES,
    inputs={"lower_position": _lower(TIMES), "lower_velocity": np.gradient(_lower(TIMES), TIMES)},
    step_size=2e-6,
    interval=2e-5,
    outputs=("lower_force", "upper_force", "lower_compression", "upper_compression"),
)
