"""FMU of a mass on a spring, driven by a force."""

from ..fmi.description import Experiment
from ..terminal_kinds import translation

EXPERIMENT = Experiment(stop_time=10.0, step_size=1e-3)

TERMINALS = {"end": translation("what the force comes from")}
