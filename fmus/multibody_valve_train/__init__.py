"""FMU of the valve train as rigid bodies with joints."""

import numpy as np

from ..fmi.description import Experiment
from ..reference_results.stimulus import Stimulus
from ..terminal_kinds import rotation

# Two turns of the cam at 1000 rpm.
EXPERIMENT = Experiment(stop_time=0.12, step_size=1e-5)
PYTHON_ONLY = (
    "its equations need memory that native code does not allocate; take the FMU in Python, or camshaft and "
    "valve_spring"
)

TERMINALS = {"drive": rotation("drive")}

SPEED = 100.0  # rad/s, of the cam
BEGIN = 1.5  # rad, shortly before the lift
TIMES = np.arange(34) * 1e-3
W = np.pi / 0.011  # rad/s, of the film


STIMULUS = Stimulus(
    says=(
        "A lift of the cam at 100 rad/s, from shortly before it to its end, on a film that swings between "
        "0.4 and 1.2 um, as broken lines. The follower starts at rest at zero lift and vibrates on its "
        "contact."
    ),
    corners=TIMES,
    inputs={
        "drive_angle": BEGIN + SPEED * TIMES,
        "drive_speed": SPEED + 0.0 * TIMES,
        "film_thickness": 0.8e-6 + 0.4e-6 * np.cos(W * TIMES),
        "film_rate": -0.4e-6 * W * np.sin(W * TIMES),
    },
    step_size=1e-5,
    interval=5e-4,
    outputs=(
        "load", "elastic_load", "deflection", "guide_moment", "position", "velocity", "spring_force",
        "entraining_velocity", "drive_torque", "cam_lift",
    ),
)  # fmt: skip
