"""FMU of the slider-crank with a tilting piston on a free crank."""

import numpy as np

from ..fmi.description import Experiment
from ..reference_results.stimulus import Stimulus

# Some turns at 1000 rpm.
EXPERIMENT = Experiment(stop_time=0.2, step_size=1e-5)


TIMES = np.arange(61) * 1e-3

STIMULUS = Stimulus(
    says=(
        "A crank at rest is driven by 20 N m, then 60 N m, while the gas presses on the piston for 20 "
        "ms: the piston goes to its wall in a sequence of impacts and slides."
    ),
    corners=TIMES,
    inputs={
        "crank_drive": np.clip(20.0 + 2e3 * (TIMES - 0.02), 20.0, 60.0),
        "gas_pressure": 2e6 * np.sin(np.pi * np.clip((TIMES - 0.01) / 0.02, 0.0, 1.0)) ** 2,
    },
    step_size=1e-5,
    interval=6e-4,
    outputs=(
        "crank_angle", "crank_speed", "piston_velocity", "piston_offset", "piston_tilt", "lower_front_force",
        "pin_force_along", "impact_count", "impact_loss",
    ),
)  # fmt: skip
