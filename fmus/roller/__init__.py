"""FMU of the roller."""

import numpy as np

from ..reference_results.stimulus import Stimulus

TIMES = np.arange(51) * 1e-3

STIMULUS = Stimulus(
    says=(
        "A roller at rest on a cam of 2 m/s that grows faster and slower: it slips until it has the speed of "
        "the cam, rolls, and slips again while its load is 5 N."
    ),
    corners=TIMES,
    inputs={
        "rolling_velocity": 2.0 + 0.5 * np.sin(2.0 * np.pi * TIMES / 0.02),
        "load": np.where((TIMES > 0.025) & (TIMES < 0.035), 5.0, 400.0),
        "pin_torque": np.full(TIMES.size, 0.01),
        "rotation_rate": 10.0 * np.sin(2.0 * np.pi * TIMES / 0.017),
    },
    step_size=1e-5,
    interval=5e-4,
    outputs=("surface_speed", "spin", "traction", "traction_margin", "carrier_torque", "power_loss"),
)
