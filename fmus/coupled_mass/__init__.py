"""FMU of a mass with the spring that couples it to another mass."""

from ..fmi.description import Experiment
from ..terminal_kinds import translation

EXPERIMENT = Experiment(stop_time=10.0, step_size=1e-3)

TERMINALS = {"other": translation("the mass at the spring's other end", "other_position", "other_velocity")}
