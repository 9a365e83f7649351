"""FMU of the slider-crank with a tilting piston on a driven crank."""

from ..fmi.description import Experiment
from ..fmi.terminals import Terminal

# Two four-stroke cycles at 2000 rpm.
EXPERIMENT = Experiment(stop_time=0.12, step_size=1e-5)

TERMINALS = {
    "crank": Terminal(
        "rotation",
        "turned by a shaft",
        {
            "angle": "crank_angle",
            "speed": "crank_speed",
            "acceleration": "crank_acceleration",
            "torque": "crank_torque",
            "impulse": "crank_impact_impulse",
        },
    ),
    "gas": Terminal("gas", "pressure on the piston", {"pressure": "gas_pressure"}),
}
