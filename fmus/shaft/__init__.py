"""FMU of the shaft with cams."""

from ..fmi.description import Experiment
from ..terminal_kinds import cam_on_shaft, rotation

# Two turns at 1000 rpm.
EXPERIMENT = Experiment(stop_time=0.12, step_size=1e-5)

TERMINALS = {"drive": rotation("drive"), "cam[*]": cam_on_shaft("a cam", "[*]")}
