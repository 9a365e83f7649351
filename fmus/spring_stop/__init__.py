"""FMU of a spring stop."""

from ..fmi.description import Experiment
from ..terminal_kinds import translation

EXPERIMENT = Experiment(stop_time=1.0, step_size=1e-4)

TERMINALS = {"end": translation("what strikes it")}
