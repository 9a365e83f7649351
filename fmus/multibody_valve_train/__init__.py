"""FMU of the valve train as rigid bodies with joints."""

from ..fmi.description import Experiment
from ..terminal_kinds import rotation

# Two turns of the cam at 1000 rpm.
EXPERIMENT = Experiment(stop_time=0.12, step_size=1e-5)
PYTHON_ONLY = (
    "its equations need memory that native code does not allocate; take the FMU in Python, or camshaft and "
    "valve_spring"
)

TERMINALS = {"drive": rotation("drive")}
