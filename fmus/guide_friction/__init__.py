"""FMU of the guide friction."""

import numpy as np

from ..fmi.description import Experiment
from ..fmi.terminals import Terminal
from ..reference_results.stimulus import Stimulus

EXPERIMENT = Experiment(stop_time=0.1, step_size=1e-5)

TERMINALS = {
    "body": Terminal(
        "guide_friction",
        "the body in the guide",
        {
            "velocity": "velocity",
            "side_force": "side_force",
            "moment": "side_moment",
            "force": "friction_force",
        },
    )
}

TIMES = np.arange(51) * 1e-3

STIMULUS = Stimulus(
    says="A valve that moves to and fro with 2 m/s at most and rests, under up to 100 N and 2 N m.",
    corners=TIMES,
    inputs={
        "velocity": 2.0 * np.exp(-TIMES / 5e-3) * np.cos(2.0 * np.pi * TIMES / 0.012),
        "side_force": 100.0 * np.sin(2.0 * np.pi * TIMES / 0.031),
        "side_moment": 2.0 * np.cos(2.0 * np.pi * TIMES / 0.023),
    },
    step_size=1e-5,
    interval=5e-4,
    outputs=("friction_force", "viscous_friction", "near_load", "far_load", "sticking_margin", "power_loss"),
)
