"""FMU of the valve on its spring."""

from ..fmi.description import Experiment
from ..terminal_kinds import GAS_ON_HEAD, translation

# Fifty periods of the default spring's surge.
EXPERIMENT = Experiment(stop_time=0.1, step_size=1e-5)

TERMINALS = {
    "load": translation("the follower that a contact loads", force="load"),
    "gas": GAS_ON_HEAD,
}
