"""FMU of a mass with the spring that couples it to another mass."""

from ..fmi.description import Experiment
from ..reference_results.stimulus import Stimulus

EXPERIMENT = Experiment(stop_time=10.0, step_size=1e-3)


STIMULUS = Stimulus(
    says="The other mass jumps by 1 m at 1 s and moves back at 0.25 m/s from 3 to 7 s.",
    corners=[0.0, 1.0, 1.0, 3.0, 3.0, 7.0, 7.0, 10.0],
    inputs={
        "other_position": [0.0, 0.0, 1.0, 1.0, 1.0, 0.0, 0.0, 0.0],
        "other_velocity": [0.0, 0.0, 0.0, 0.0, -0.25, -0.25, 0.0, 0.0],
    },
    step_size=1e-3,
    interval=0.08,
    outputs=("force", "position", "velocity"),
)
