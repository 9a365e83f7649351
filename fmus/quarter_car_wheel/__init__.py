"""FMU of the quarter car's wheel."""

from ..fmi.description import Experiment
from ..reference_results.stimulus import Stimulus

EXPERIMENT = Experiment(stop_time=4.0, step_size=1e-3)


STIMULUS = Stimulus(
    says=("The wheel hops up a step of the road, under a chassis that follows by 0.05 m and comes back."),
    corners=[0.0, 0.2, 0.2, 0.6, 0.6, 2.0],
    inputs={
        "chassis_position": [0.0, 0.05, 0.05, 0.03, 0.03, 0.03],
        "chassis_velocity": [0.25, 0.25, -0.05, -0.05, 0.0, 0.0],
    },
    step_size=1e-3,
    interval=2e-2,
    outputs=("position", "velocity", "suspension_force", "tyre_force"),
)
