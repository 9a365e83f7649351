"""FMU of the valve on its seat."""

from ..fmi.description import Experiment
from ..terminal_kinds import GAS_ON_HEAD, translation

EXPERIMENT = Experiment(stop_time=0.1, step_size=1e-5)

TERMINALS = {
    "load": translation("what opens the valve", force="load"),
    "spring[*]": translation("a spring that closes the valve", force="spring_force[*]"),
    "gas": GAS_ON_HEAD,
}
