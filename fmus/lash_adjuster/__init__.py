"""FMU of the lash adjuster."""

from ..fmi.description import Experiment
from ..terminal_kinds import translation

# Two and a half times the time in which the default chamber relaxes.
EXPERIMENT = Experiment(stop_time=0.1, step_size=1e-5)

TERMINALS = {
    "lower": translation("the body below", "lower_position", "lower_velocity"),
    "upper": translation("the body above", "upper_position", "upper_velocity"),
}
