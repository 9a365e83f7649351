"""FMU of the lubricated line contact."""

from ..description import Experiment

# With a pressure field, so that the film may be solved for. Formulas do not touch it.
STRUCTURE = {"nodes": 301}
EXPERIMENT = Experiment(stop_time=0.1, step_size=1e-5)
# In machine code the film follows formulas.
NATIVE_STRUCTURE = {"nodes": 0}
