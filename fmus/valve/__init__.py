"""FMU of the valve on its seat."""

from ..fmi.description import Experiment
from ..fmi.terminals import Terminal

EXPERIMENT = Experiment(stop_time=0.1, step_size=1e-5)

TERMINALS = {
    "load": Terminal(
        "translation",
        "what opens the valve",
        {"position": "position", "velocity": "velocity", "force": "load"},
    ),
    "spring[*]": Terminal(
        "translation",
        "a spring that closes the valve",
        {"position": "position", "velocity": "velocity", "force": "spring_force[*]"},
    ),
    "gas": Terminal("gas_force", "gas on the head", {"force": "gas_force"}),
}
