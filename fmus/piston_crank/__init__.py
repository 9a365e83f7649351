"""FMU of the slider-crank with a tilting piston on a driven crank."""

from ..description import Experiment

# Two four-stroke cycles at 2000 rpm.
EXPERIMENT = Experiment(stop_time=0.12, step_size=1e-5)
