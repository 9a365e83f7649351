"""FMU of the slider-crank with a tilting piston on a driven crank."""

from ..fmi.description import Experiment
from ..terminal_kinds import CRANK, CYLINDER_PRESSURE

# Two four-stroke cycles at 2000 rpm.
EXPERIMENT = Experiment(stop_time=0.12, step_size=1e-5)

TERMINALS = {"crank": CRANK, "gas": CYLINDER_PRESSURE}
