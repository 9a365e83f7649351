"""FMU of the slider-crank with a tilting piston on a free crank."""

from ..fmi.description import Experiment
from ..terminal_kinds import CYLINDER_PRESSURE

# Some turns at 1000 rpm.
EXPERIMENT = Experiment(stop_time=0.2, step_size=1e-5)

TERMINALS = {"gas": CYLINDER_PRESSURE}
