"""FMU of the tappet's spin."""

import numpy as np

from ..reference_results.stimulus import Stimulus

TIMES = np.arange(61) * 1e-3

STIMULUS = Stimulus(
    says="A tappet at rest, which a cam turns that slides with 2.2 to 3 m/s, under 20 to 60 N of friction.",
    corners=TIMES,
    inputs={
        "sliding_velocity": 2.6 - 0.4 * np.cos(2.0 * np.pi * TIMES / 0.06),
        "contact_offset": 8e-3 * np.sin(2.0 * np.pi * TIMES / 0.06),
        "friction_force": 40.0 + 20.0 * np.sin(2.0 * np.pi * TIMES / 0.03),
    },
    step_size=1e-5,
    interval=5e-4,
    outputs=("spin", "contact_sliding", "cam_friction", "spin_torque", "bore_torque", "power_loss"),
)
