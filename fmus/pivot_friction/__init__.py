"""FMU of the pivot friction."""

from ..fmi.description import Experiment
from ..terminal_kinds import pivot_friction

EXPERIMENT = Experiment(stop_time=0.1, step_size=1e-5)

TERMINALS = {
    "lever": pivot_friction("the lever on the pivot", "rotation_rate", "load", "friction_torque"),
}
