"""FMU of the tappet."""

from ..fmi.description import Experiment
from ..terminal_kinds import CAM, CAM_DRIVE, translation

# Two turns of the cam at 1000 rpm.
EXPERIMENT = Experiment(stop_time=0.12, step_size=1e-5)

TERMINALS = {
    "cam": CAM,
    "shaft": CAM_DRIVE,
    "train": translation("what stands on the follower", force="load"),
}
