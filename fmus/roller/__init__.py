"""FMU of the roller."""

from ..fmi.description import Experiment
from ..fmi.terminals import Terminal
from ..terminal_kinds import pivot_friction

EXPERIMENT = Experiment(stop_time=0.1, step_size=1e-5)

TERMINALS = {
    "carrier": Terminal(
        "roller",
        "the body that carries the pin, and the cam",
        {"speed": "surface_speed", "rolling_velocity": "rolling_velocity", "traction": "traction"},
    ),
    "pin": pivot_friction("friction of the pin", "spin", "load", "pin_torque"),
}
