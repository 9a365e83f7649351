"""FMU of the finger follower."""

from ..fmi.description import Experiment
from ..terminal_kinds import CAM, CAM_DRIVE, TIP, pivot_friction, translation

# Two turns of the cam at 1000 rpm.
EXPERIMENT = Experiment(stop_time=0.12, step_size=1e-5)

TERMINALS = {
    "cam": CAM,
    "shaft": CAM_DRIVE,
    "tip": TIP,
    "pivot": translation(
        "the lash adjuster under the pivot", "pivot_position", "pivot_velocity", "pivot_force"
    ),
    "pivot_friction": pivot_friction(
        "friction of the pivot", "rotation_rate", "support_force", "pivot_torque"
    ),
}
