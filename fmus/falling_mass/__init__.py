"""FMU of a mass under gravity and a force."""

from ..fmi.description import Experiment
from ..reference_results.stimulus import Stimulus

EXPERIMENT = Experiment(stop_time=1.0, step_size=1e-4)


STIMULUS = Stimulus(
    says=(
        "Free fall for 0.1 s, then a force that grows to 30 N and throws the mass up again, then free flight."
    ),
    corners=[0.0, 0.1, 0.3, 0.3, 0.5],
    inputs={"force": [0.0, 0.0, 30.0, 0.0, 0.0]},
    step_size=1e-4,
    interval=4e-3,
    outputs=("position", "velocity"),
)
