"""FMU of a spring stop."""

import numpy as np

from ..fmi.description import Experiment
from ..reference_results.stimulus import Stimulus

EXPERIMENT = Experiment(stop_time=1.0, step_size=1e-4)


TIMES = np.arange(51) * 1e-2
PHASE = np.pi * TIMES / 0.5

STIMULUS = Stimulus(
    says="What strikes the stop presses it by 20 mm and leaves it again: contact made and lost.",
    corners=TIMES,
    inputs={"position": 0.05 - 0.07 * np.sin(PHASE), "velocity": -0.07 * np.pi / 0.5 * np.cos(PHASE)},
    step_size=1e-3,
    interval=5e-3,
    outputs=("force", "compression", "contact_margin", "impulse"),
)
