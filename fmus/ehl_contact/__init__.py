"""FMU of the lubricated line contact."""

import numpy as np

from ..reference_results.stimulus import Stimulus

DURATION, DEPTH = 50e-3, 5e-6
TIMES = np.arange(51) * 1e-3
PHASE = np.pi * TIMES / DURATION

STIMULUS = Stimulus(
    says=(
        "Two bodies approach each other by 5 um and part again in 50 ms (load up to 2.2 kN, 0.58 "
        "GPa), while the entraining velocity goes from 1.2 to -0.8 m/s and back, twice through zero, "
        "where the film is squeezed out to 90 nm and asperities carry a part. Film by the default "
        "formula."
    ),
    corners=TIMES,
    inputs={
        "approach": DEPTH * np.sin(PHASE) ** 2,
        "approach_rate": DEPTH * np.pi / DURATION * np.sin(2.0 * PHASE),
        "entraining_velocity": 0.2 + np.cos(2.0 * PHASE),
        "sliding_velocity": 0.3 + 0.0 * TIMES,
    },
    step_size=1e-5,
    interval=1e-3,
    outputs=(
        "load", "film_thickness", "squeeze_velocity", "steady_film_thickness", "maximum_pressure",
        "friction_force", "viscous_friction", "asperity_load", "damping_margin",
    ),
)  # fmt: skip
