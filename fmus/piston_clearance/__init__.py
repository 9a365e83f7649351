"""FMU of the clearance between a valve and the piston."""

import numpy as np

from ..reference_results.stimulus import Stimulus

TIMES = np.arange(61) * 1e-3

STIMULUS = Stimulus(
    says="Two turns of the crank; the valve lifts by 9 mm about the top dead centre between them.",
    corners=TIMES,
    inputs={
        "angle": 4.0 * np.pi * TIMES / TIMES[-1],
        "valve_lift": 9e-3 * np.exp(-(((TIMES - 0.03) / 8e-3) ** 2)),
    },
    step_size=1e-4,
    interval=5e-4,
    outputs=("clearance", "radial_clearance", "piston_travel"),
)
