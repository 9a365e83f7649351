"""FMU of the sphere of a nonlinear loop."""

from ..fmi.description import Experiment
from ..reference_results.stimulus import Stimulus

EXPERIMENT = Experiment(stop_time=1.0, step_size=0.01)


STIMULUS = Stimulus(
    says="The first coordinate grows from 0.6 to 1 while the second stays.",
    corners=[0.0, 0.5, 1.0],
    inputs={"a": [0.6, 1.0, 1.0], "b": [-1.8, -1.8, -1.8]},
    step_size=0.01,
    interval=0.01,
    outputs=("c", "square"),
)
