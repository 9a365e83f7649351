"""Small FMUs made with pythonfmu: the second mass of `two_masses`, with its force held, and its vices.

They know nothing of this project, as a third-party FMU. The mass on its spring and damper under a
constant force is solved exactly, so that what is seen is the exchange.
"""

import sys
from pathlib import Path

from pythonfmu.builder import FmuBuilder

_SLAVE = """
import ctypes
import math
import numpy as np
from scipy.linalg import expm
from pythonfmu import Fmi2Causality, Fmi2Slave, Fmi2Variability, Real

# The C layer runs this file anew for every instance and gives back a reference that it was only lent.
ctypes.pythonapi.Py_IncRef(ctypes.py_object(globals()))

class {name}(Fmi2Slave):
    def __init__(self, **kwargs):
        super().__init__(**kwargs)
        self.mass, self.stiffness, self.damping = 1.0, 10.0, 0.5
        self.coupling_stiffness, self.coupling_damping = 40.0, 1.0
        self.force = self.position = self.velocity = self.position_start = self.velocity_start = 0.0
        self.failed = 0.0
        for one in ("mass", "stiffness", "damping", "coupling_stiffness", "coupling_damping",
                    "position_start", "velocity_start"):
            self.register_variable(Real(one, causality=Fmi2Causality.parameter,
                                        variability=Fmi2Variability.fixed))
        self.register_variable(Real("force", causality=Fmi2Causality.input))
        self.register_variable(Real("position", causality=Fmi2Causality.output))
        self.register_variable(Real("velocity", causality=Fmi2Causality.output))
        self.register_variable(Real("failed", causality=Fmi2Causality.local))
{at_start}

    def exit_initialization_mode(self):
        self.position, self.velocity = self.position_start, self.velocity_start
{when_initialised}

    def do_step(self, t, h):
{before_step}
        a = np.array([[0.0, 1.0], [-self.stiffness / self.mass, -self.damping / self.mass]])
        rest = np.array([self.force / self.stiffness, 0.0])
        x = rest + expm(a * h) @ (np.array([self.position, self.velocity]) - rest)
        self.position, self.velocity = float(x[0]), float(x[1])
        return True
"""

# Where a vice's code goes, and what it is. Times and lengths in seconds.
VICES = {
    "sound": {},
    "refusing": {"before_step": "if t > 0.5: self.log('no way on'); return False"},
    "raising": {"before_step": "if t > 0.5: raise RuntimeError('broken gear')"},
    "unborn": {"at_start": "raise RuntimeError('no licence')"},
    "unready": {"when_initialised": "raise RuntimeError('no table found')"},
    "infinite": {"before_step": "if t > 0.5: self.velocity = math.inf; return True"},
}


def small_fmu(vice: str, folder: Path, restorable: bool = False) -> Path:
    """The FMU with a vice of `VICES`; `restorable`: it says that its state can be saved."""
    name = f"second_{vice}{'_kept' if restorable else ''}"
    places = dict.fromkeys(("at_start", "when_initialised", "before_step"), "pass") | VICES[vice]
    # A slave is made once while its description is written; there it must not fail.
    if vice == "unborn":
        places["at_start"] = f"if self.instance_name != 'dummyInstance': {places['at_start']}"
    script = folder / f"{name}.py"
    script.write_text(_SLAVE.format(name=name, **{key: f"        {code}" for key, code in places.items()}))
    path = list(sys.path)
    try:
        return Path(FmuBuilder.build_FMU(script, folder / f"{name}.fmu", canGetAndSetFMUstate=restorable))
    finally:
        sys.path[:] = path  # the builder leaves the folder there
        sys.modules.pop(name, None)
