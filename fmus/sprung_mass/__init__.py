"""FMU of a mass on a spring, driven by a force."""

from ..fmi.description import Experiment
from ..reference_results.stimulus import Stimulus

EXPERIMENT = Experiment(stop_time=10.0, step_size=1e-3)


STIMULUS = Stimulus(
    says="A force that jumps to 10 N at 1 s, stays, and falls to -5 N from 4 to 6 s.",
    corners=[0.0, 1.0, 1.0, 4.0, 6.0, 10.0],
    inputs={"force": [0.0, 0.0, 10.0, 10.0, -5.0, -5.0]},
    step_size=1e-3,
    interval=0.08,
    outputs=("position", "velocity"),
)
