"""FMU of the rod."""

from ..fmi.description import Experiment
from ..terminal_kinds import translation

# Two hundred periods of the default rod between rigid ends.
EXPERIMENT = Experiment(stop_time=0.02, step_size=2e-6)

TERMINALS = {
    "lower": translation("the body below", "lower_position", "lower_velocity", "lower_force"),
    "upper": translation("the body above", "upper_position", "upper_velocity", "upper_force"),
}
