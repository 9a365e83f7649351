"""FMU of the valve train as rigid bodies with joints."""

from ..fmi.description import Experiment
from ..fmi.terminals import Terminal

# Two turns of the cam at 1000 rpm.
EXPERIMENT = Experiment(stop_time=0.12, step_size=1e-5)
PYTHON_ONLY = (
    "its equations need memory that native code does not allocate; take the FMU in Python, or camshaft and "
    "valve_spring"
)

TERMINALS = {
    "drive": Terminal(
        "rotation",
        "turned by a shaft",
        {
            "angle": "drive_angle",
            "speed": "drive_speed",
            "acceleration": "drive_acceleration",
            "torque": "drive_torque",
        },
    ),
}
