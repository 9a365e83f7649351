"""FMU of the gas pressure of a four-stroke cycle."""

from ..fmi.description import Experiment
from ..fmi.terminals import Terminal

# Two cycles at 2000 rpm.
EXPERIMENT = Experiment(stop_time=0.12, step_size=1e-5)

TERMINALS = {
    "crank": Terminal("rotation", "timing", {"angle": "crank_angle", "speed": "crank_speed"}, partial=True),
    "gas": Terminal("gas", "pressure on the piston", {"pressure": "gas_pressure"}),
    "valve[*]": Terminal("gas_force", "force on a valve's head", {"force": "valve_force[*]"}),
}
