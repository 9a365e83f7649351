"""FMU of the lubricated line contact with a solved pressure field."""

from ..ehl_contact import TERMINALS
from ..fmi.description import Experiment

__all__ = ["TERMINALS"]

EXPERIMENT = Experiment(stop_time=0.1, step_size=1e-5)
PYTHON_ONLY = "its pressure field needs Python; take the FMU in Python, or ehl_contact with a film formula"
