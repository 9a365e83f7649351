"""FMU of the flywheel."""

from ..fmi.description import Experiment
from ..reference_results.stimulus import Stimulus

EXPERIMENT = Experiment(stop_time=1.0, step_size=1e-3)


STIMULUS = Stimulus(
    says=(
        "The shaft turns at its prescribed speed, 1000 r/min, while a mechanism loads it with a "
        "torque that grows to 30 N m, falls, and changes its sign: what the drive supplies."
    ),
    corners=[0.0, 0.1, 0.25, 0.4],
    inputs={"load_torque[1]": [0.0, 30.0, -5.0, 10.0]},
    step_size=1e-3,
    interval=4e-3,
    outputs=("angle", "speed", "supplied_torque", "throw_angle[1]"),
)
