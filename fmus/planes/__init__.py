"""FMU of the planes of a nonlinear loop."""

from ..fmi.description import Experiment
from ..reference_results.stimulus import Stimulus

EXPERIMENT = Experiment(stop_time=1.0, step_size=0.01)


STIMULUS = Stimulus(
    says="The third coordinate grows from 1 to 2 and falls to -1.",
    corners=[0.0, 0.5, 1.0],
    inputs={"c": [1.0, 2.0, -1.0]},
    step_size=0.01,
    interval=0.01,
    outputs=("a", "square"),
)
