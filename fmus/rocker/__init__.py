"""FMU of the rocker."""

from ..fmi.description import Experiment
from ..terminal_kinds import TIP, pivot_friction, translation

EXPERIMENT = Experiment(stop_time=0.1, step_size=1e-5)

TERMINALS = {
    "tip": TIP,
    "rod": translation("the pushrod's end", "rod_position", "rod_velocity", "rod_force"),
    "pivot_friction": pivot_friction("friction of the pivot", "rotation_rate", "pivot_force", "pivot_torque"),
}
