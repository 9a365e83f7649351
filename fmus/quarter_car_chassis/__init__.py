"""FMU of the quarter car's chassis."""

from ..fmi.description import Experiment
from ..reference_results.stimulus import Stimulus

EXPERIMENT = Experiment(stop_time=4.0, step_size=1e-3)


STIMULUS = Stimulus(
    says=(
        "The wheel rises by 0.1 m in 0.2 s, stays up for 0.8 s and returns; the chassis follows and "
        "swings out."
    ),
    corners=[0.0, 0.2, 0.2, 1.0, 1.0, 1.2, 1.2, 3.0],
    inputs={
        "wheel_position": [0.0, 0.1, 0.1, 0.1, 0.1, 0.0, 0.0, 0.0],
        "wheel_velocity": [0.5, 0.5, 0.0, 0.0, -0.5, -0.5, 0.0, 0.0],
    },
    step_size=1e-3,
    interval=2.5e-2,
    outputs=("position", "velocity", "suspension_force"),
)
