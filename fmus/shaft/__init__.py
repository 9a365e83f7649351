"""FMU of the shaft with cams."""

import numpy as np

from ..reference_results.stimulus import Stimulus

SPEED = 100.0  # rad/s
TIMES = np.arange(41) * 1e-3

STIMULUS = Stimulus(
    says=(
        "A shaft at 100 rad/s under a cam's torque and forces, as broken lines over 40 ms whose corners "
        "excite torsion and bending."
    ),
    corners=TIMES,
    inputs={
        "drive_angle": SPEED * TIMES,
        "drive_speed": SPEED + 0.0 * TIMES,
        "cam_torque[1]": 5.0 * np.sin(2.0 * np.pi * TIMES / 0.02),
        "cam_force_x[1]": 30.0 * np.sin(2.0 * np.pi * TIMES / 0.01),
        "cam_force_y[1]": -400.0 - 200.0 * np.cos(2.0 * np.pi * TIMES / 0.02),
    },
    step_size=1e-5,
    interval=4e-4,
    outputs=(
        "cam_angle[1]",
        "cam_speed[1]",
        "twist[1]",
        "axis_x[1]",
        "axis_y[1]",
        "axis_velocity_x[1]",
        "axis_velocity_y[1]",
        "drive_torque",
    ),
)
